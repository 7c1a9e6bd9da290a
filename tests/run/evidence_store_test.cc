// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/evidence_store.h"

#include "tests/support/external_writers.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

constexpr const char* kKey = "options inputs";

// The smallest evidence that a file takes, with a number to identify it.
ViewEvidence EvidenceOf(int image) {
  ViewEvidence evidence;
  evidence.width = 2;
  evidence.height = 1;
  evidence.noise = static_cast<float>(image);
  evidence.superpixels = Image<uint16_t>(2, 1);
  evidence.confident_depth = Image<float>(2, 1);
  evidence.color = Image<Rgb>(2, 1);
  evidence.weights = {1.f};
  evidence.first_observation = {0, 0};
  evidence.first_confirmed = {0, 0};
  evidence.confirmed_pixels = {0};
  evidence.flags = Image<uint8_t>(4, 3, 7);
  return evidence;
}

// Images 0 to 2 are "a.png", "left/b.png", whose sources are the other two, and
// "c.png".
class EvidenceStoreTest : public testing::Test {
 protected:
  void SetUp() override { MakeTestWorkspace(root_); }

  // As a later run would see it.
  bool IsCurrent(int image,
                 const std::string& key = kKey,
                 MapType type = MapType::kGeometric) const {
    const Workspace workspace(root_, type);
    EvidenceStore store(workspace, key, 4);
    const bool is_current = store.IsCurrent(image);
    EXPECT_EQ(store.IsObserved(image), is_current);
    if (is_current) {
      EXPECT_NE(store.Get(image), nullptr);
    } else {
      ExpectError(ErrorCode::kNotFound,
                  {workspace.Name(image) + ".", "observe of all shards again"},
                  [&] { store.Get(image); });
    }
    return is_current;
  }
  std::filesystem::path Folder() const {
    return root_ / "stereo/tsar/evidence";
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

TEST_F(EvidenceStoreTest, GivesBackWhatWasWritten) {
  const Workspace workspace(root_, MapType::kGeometric);
  EvidenceStore store(workspace, kKey, 4);
  EXPECT_FALSE(store.IsCurrent(1));
  store.Write(1, EvidenceOf(1));
  EXPECT_TRUE(store.IsCurrent(1));
  EXPECT_FALSE(store.IsCurrent(0));

  const ViewEvidence all = store.ReadAll(1);
  EXPECT_EQ(all.noise, 1.f);
  EXPECT_EQ(all.flags.Width(), 4);
  EXPECT_EQ(all.flags(3, 2), 7);
  const EvidenceStore::Evidence some = store.Get(1);
  ASSERT_NE(some, nullptr);
  EXPECT_EQ(some->noise, 1.f);
  EXPECT_EQ(some->weights.size(), 1u);
  EXPECT_TRUE(some->flags.Empty());
  EXPECT_TRUE(IsCurrent(1));
  EXPECT_FALSE(IsCurrent(1, "options other inputs"));
  EXPECT_FALSE(IsCurrent(1, kKey, MapType::kPhotometric));
  // If the image is no longer a reference, nobody renews its evidence.
  WriteText(root_ / "stereo/patch-match.cfg", "a.png\nleft/b.png\n");
  const Workspace without(root_, MapType::kGeometric);
  EXPECT_FALSE(EvidenceStore(without, kKey, 4).IsObserved(1));
  EXPECT_EQ(EvidenceStore(without, kKey, 4).Get(1), nullptr);
}

TEST_F(EvidenceStoreTest, PriorsOfWhichMostDoNotFitAreAllLeftOut) {
  for (const char* name : {"a.pfm", "left/b.pfm", "c.pfm"}) {
    WriteText(folder_.Path() / "priors" / name,
              PfmBytes(4, 3, 1, std::vector<float>(12, 1.f), true));
  }
  // Every image has sources.
  WriteText(root_ / "stereo/patch-match.cfg",
            "a.png\n__all__\nleft/b.png\n__all__\nc.png\n__all__\n");
  Workspace workspace(root_, MapType::kGeometric);
  workspace.UsePriors(folder_.Path() / "priors", PriorType::kAuto);
  const auto verdict_of_b = [&](PriorVerdict of_c) {
    EvidenceStore store(workspace, kKey, 4);
    const PriorVerdict verdicts[] = {
        PriorVerdict::kUnlike, PriorVerdict::kUsed, of_c};
    for (int image = 0; image < 3; ++image) {
      ViewEvidence evidence = EvidenceOf(image);
      evidence.prior.assessment.verdict = verdicts[image];
      if (verdicts[image] == PriorVerdict::kUsed) {
        evidence.prior.depth = Image<float>(2, 1, 1.f);
        evidence.prior.sigma = Image<float>(2, 1, 0.1f);
        evidence.prior.outlier_share = 0.1f;
      }
      store.Write(image, evidence);
    }
    store.RemoveUnlikePriors();
    EXPECT_EQ(store.ReadAll(0).prior.assessment.verdict, PriorVerdict::kUnlike);
    // A later run, or another machine, reads the same.
    const AlignedPrior prior =
        EvidenceStore(workspace, kKey, 4).ReadAll(1).prior;
    EXPECT_EQ(prior.Empty(), prior.assessment.verdict != PriorVerdict::kUsed);
    return prior.assessment.verdict;
  };
  EXPECT_EQ(verdict_of_b(PriorVerdict::kUnlike), PriorVerdict::kOthersUnlike);
  EXPECT_EQ(verdict_of_b(PriorVerdict::kUsed), PriorVerdict::kUsed);
  // Where too little was measured, nothing is known about the prior.
  EXPECT_EQ(verdict_of_b(PriorVerdict::kFewMeasured), PriorVerdict::kUsed);
}

TEST_F(EvidenceStoreTest, KeepsThatThereIsNothingToObserve) {
  const Workspace workspace(root_, MapType::kGeometric);
  EvidenceStore store(workspace, kKey, 4);
  store.WriteNothing(1);
  EXPECT_TRUE(store.IsObserved(1));
  EXPECT_FALSE(store.IsCurrent(1));
  EXPECT_EQ(store.Get(1), nullptr);
  EXPECT_FALSE(EvidenceStore(workspace, "others", 4).IsObserved(1));
}

TEST_F(EvidenceStoreTest, ClearRemovesTheFolderAndNothingElse) {
  const Workspace workspace(root_, MapType::kGeometric);
  EvidenceStore::Clear(workspace);  // Nothing there yet.
  for (const int image : {0, 1, 2}) {
    EvidenceStore(workspace, kKey, 4).Write(image, EvidenceOf(image));
  }
  const std::filesystem::path other = root_ / "stereo/tsar/manifest.json";
  WriteText(other, "{}");
  EvidenceStore::Clear(workspace);
  EXPECT_FALSE(std::filesystem::exists(Folder()));
  EXPECT_TRUE(std::filesystem::exists(other));
  EXPECT_FALSE(IsCurrent(1));
}

}  // namespace
}  // namespace tsar
