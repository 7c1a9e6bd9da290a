// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/evidence_store.h"

#include <chrono>
#include <thread>

#include "tests/support/external_writers.h"
#include "tests/support/test_workspace.h"
#include "tests/support/write_refined.h"

namespace tsar {
namespace {

constexpr const char* kOptions = "0123456789abcdef";

// The smallest that a file takes, with a number to tell it by.
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

  Workspace Open(MapType type = MapType::kGeometric) const {
    return Workspace(root_, type);
  }
  // As a later run would see it.
  bool IsCurrent(int image,
                 const std::string& options = kOptions,
                 MapType type = MapType::kGeometric) const {
    const Workspace workspace = Open(type);
    InputFingerprints inputs(workspace);
    EvidenceStore store(workspace, inputs, options, 4);
    const bool is_current = store.IsCurrent(image);
    EXPECT_EQ(store.Get(image) != nullptr, is_current);
    return is_current;
  }
  void Write(int image) const {
    const Workspace workspace = Open();
    InputFingerprints inputs(workspace);
    EvidenceStore(workspace, inputs, kOptions, 4)
        .Write(image, EvidenceOf(image));
  }
  std::filesystem::path File(const std::string& image) const {
    return Folder() / (image + ".geometric.bin");
  }
  std::filesystem::path Folder() const {
    return root_ / "stereo/tsar/evidence";
  }

  // What a program that writes a file anew does to its time.
  static void Touch(const std::filesystem::path& path) {
    std::filesystem::last_write_time(
        path, std::filesystem::last_write_time(path) + std::chrono::seconds(2));
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

TEST_F(EvidenceStoreTest, GivesBackWhatWasWritten) {
  const Workspace workspace = Open();
  InputFingerprints inputs(workspace);
  EvidenceStore store(workspace, inputs, kOptions, 4);
  EXPECT_FALSE(store.IsCurrent(1));
  EXPECT_EQ(store.Get(1), nullptr);
  store.Write(1, EvidenceOf(1));
  EXPECT_TRUE(store.IsCurrent(1));
  EXPECT_FALSE(store.IsCurrent(0));
  EXPECT_TRUE(std::filesystem::exists(File("left/b.png")));

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
}

TEST_F(EvidenceStoreTest, PriorsOfWhichMostDoNotFitAreAllLeftOut) {
  for (const char* name : {"a.pfm", "left/b.pfm", "c.pfm"}) {
    WriteText(folder_.Path() / "priors" / name,
              PfmBytes(4, 3, 1, std::vector<float>(12, 1.f), true));
  }
  // Every image has sources.
  WriteText(root_ / "stereo/patch-match.cfg",
            "a.png\n__all__\nleft/b.png\n__all__\nc.png\n__all__\n");
  Workspace workspace = Open();
  workspace.UsePriors(folder_.Path() / "priors", PriorType::kAuto);
  const auto verdict_of_b = [&](PriorVerdict of_c) {
    InputFingerprints inputs(workspace);
    EvidenceStore store(workspace, inputs, kOptions, 4);
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
        EvidenceStore(workspace, inputs, kOptions, 4).ReadAll(1).prior;
    EXPECT_EQ(prior.Empty(), prior.assessment.verdict != PriorVerdict::kUsed);
    return prior.assessment.verdict;
  };
  EXPECT_EQ(verdict_of_b(PriorVerdict::kUnlike), PriorVerdict::kOthersUnlike);
  EXPECT_EQ(verdict_of_b(PriorVerdict::kUsed), PriorVerdict::kUsed);
  // Where too little was measured, nothing is known of the prior.
  EXPECT_EQ(verdict_of_b(PriorVerdict::kFewMeasured), PriorVerdict::kUsed);
}

TEST_F(EvidenceStoreTest, OtherOptionsAndOtherMapTypesAreOthers) {
  Write(1);
  EXPECT_TRUE(IsCurrent(1));
  EXPECT_FALSE(IsCurrent(1, "0123456789abcdee"));
  EXPECT_FALSE(IsCurrent(1, kOptions, MapType::kPhotometric));
}

TEST_F(EvidenceStoreTest, IsStaleOnceAFileThatItWasMadeOfHasChanged) {
  std::vector<std::filesystem::path> files;
  for (const char* image : {"left/b.png", "a.png", "c.png"}) {
    files.push_back(root_ / "images" / image);
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      const MapPaths paths = GetMapPaths(root_, image, type);
      files.push_back(paths.depth);
      files.push_back(paths.normal);
    }
  }
  for (const std::filesystem::path& file : files) {
    Write(1);
    ASSERT_TRUE(IsCurrent(1)) << file;
    Touch(file);
    EXPECT_FALSE(IsCurrent(1)) << file;
  }
  Write(1);
  std::filesystem::remove(files.back());
  EXPECT_FALSE(IsCurrent(1));
}

TEST_F(EvidenceStoreTest, IsStaleWithOtherSourcesOrCameras) {
  const std::filesystem::path config = root_ / "stereo/patch-match.cfg";
  const std::string lines = ReadText(config);
  Write(1);
  WriteText(config, "left/b.png\nc.png\n");
  EXPECT_FALSE(IsCurrent(1));
  // Of an image that is none of the references, no one renews it.
  WriteText(config, "a.png\nleft/b.png\n");
  EXPECT_FALSE(IsCurrent(1));
  WriteText(config, lines);
  EXPECT_TRUE(IsCurrent(1));

  std::string images = ReadText(root_ / "sparse/images.txt");
  images.replace(images.find("-2"), 2, "-3");  // c.png moves.
  WriteText(root_ / "sparse/images.txt", images);
  EXPECT_FALSE(IsCurrent(1));
}

TEST_F(EvidenceStoreTest, RefiningTheMapsLeavesItCurrent) {
  Write(1);
  for (const int image : {0, 1, 2}) {
    ImageRecord record;
    record.options_hash = kOptions;
    WriteRefined(Open(), image, MakeRefinedMaps(3.f), record);
  }
  EXPECT_TRUE(IsCurrent(1));
  // New maps of COLMAP in the place of the refined ones do not.
  WriteTestMaps(root_, "c.png", MapType::kGeometric, 9.f);
  EXPECT_FALSE(IsCurrent(1));
}

TEST_F(EvidenceStoreTest, DamagedFilesAreNotCurrent) {
  Write(1);
  const std::string bytes = ReadText(File("left/b.png"));
  WriteText(File("left/b.png"), bytes.substr(0, bytes.size() - 1));
  EXPECT_FALSE(IsCurrent(1));
  WriteText(File("left/b.png"), "");
  EXPECT_FALSE(IsCurrent(1));
}

TEST_F(EvidenceStoreTest, KeepsThoseUsedLast) {
  const Workspace workspace = Open();
  InputFingerprints inputs(workspace);
  EvidenceStore store(workspace, inputs, kOptions, 2);
  std::vector<EvidenceStore::Evidence> first;
  for (const int image : {0, 1, 2}) {
    store.Write(image, EvidenceOf(image));
  }
  for (const int image : {0, 1}) {
    first.push_back(store.Get(image));
    EXPECT_EQ(first.back()->noise, static_cast<float>(image));
  }
  EXPECT_EQ(store.Get(0), first[0]);
  EXPECT_EQ(store.Get(2)->noise, 2.f);  // In the place of 1.
  EXPECT_EQ(store.Get(0), first[0]);
  EXPECT_NE(store.Get(1), first[1]);
  // What others hold stays whole.
  EXPECT_EQ(first[1]->noise, 1.f);

  EvidenceStore without_memory(workspace, inputs, kOptions, 0);
  const EvidenceStore::Evidence evidence = without_memory.Get(2);
  EXPECT_EQ(evidence->noise, 2.f);
  EXPECT_NE(without_memory.Get(2), evidence);
}

TEST_F(EvidenceStoreTest, ClearRemovesTheFolderAndNothingElse) {
  const Workspace workspace = Open();
  EvidenceStore::Clear(workspace);  // Nothing there yet.
  for (const int image : {0, 1, 2}) {
    Write(image);
  }
  const std::filesystem::path other = root_ / "stereo/tsar/manifest.json";
  WriteText(other, "{}");
  EvidenceStore::Clear(workspace);
  EXPECT_FALSE(std::filesystem::exists(Folder()));
  EXPECT_TRUE(std::filesystem::exists(other));
  EXPECT_FALSE(IsCurrent(1));
}

TEST_F(EvidenceStoreTest, ManyThreadsGetWhatTheyAskFor) {
  const Workspace workspace = Open();
  InputFingerprints inputs(workspace);
  EvidenceStore store(workspace, inputs, kOptions, 2);
  for (const int image : {0, 2}) {
    store.Write(image, EvidenceOf(image));
  }
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([&, thread] {
      if (thread == 0) {
        store.Write(1, EvidenceOf(1));
      }
      for (int i = 0; i < 60; ++i) {
        const int image = (i + thread) % 3;
        const EvidenceStore::Evidence evidence = store.Get(image);
        // The second is being written.
        if (evidence || image != 1) {
          ASSERT_NE(evidence, nullptr);
          ASSERT_EQ(evidence->noise, static_cast<float>(image));
          ASSERT_TRUE(store.IsCurrent(image));
          ASSERT_EQ(store.ReadAll(image).noise, static_cast<float>(image));
        }
      }
    });
  }
  threads.clear();
  EXPECT_NE(store.Get(1), nullptr);
}

TEST_F(EvidenceStoreTest, ExpectedEvidenceMustBeThereAndCurrent) {
  const Workspace workspace = Open();
  Write(1);
  InputFingerprints inputs(workspace);
  EvidenceStore store(workspace, inputs, kOptions, 4);
  store.Expect({1});
  EXPECT_TRUE(store.IsCurrent(1));
  EXPECT_NE(store.Get(1), nullptr);
  EXPECT_FALSE(store.IsCurrent(0));
  EXPECT_EQ(store.Get(0), nullptr);

  const auto expect_refusal = [&](int image) {
    InputFingerprints of_files(workspace);
    EvidenceStore expecting(workspace, of_files, kOptions, 4);
    expecting.Expect({1, 2});
    ExpectError(ErrorCode::kMismatch, {".geometric.bin", "observe"}, [&] {
      expecting.IsCurrent(image);
    });
  };
  expect_refusal(2);
  // A file of a source of "left/b.png", which was observed in its former state.
  Touch(workspace.DepthPath(0, MapType::kPhotometric));
  expect_refusal(1);
}

}  // namespace
}  // namespace tsar
