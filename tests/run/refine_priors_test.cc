// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/run/workspace_check.h"

#include "tests/run/refine_workspace_fixture.h"
#include "tests/support/external_writers.h"
#include "tests/support/mask_files.h"

namespace tsar {
namespace {

constexpr int kWidth = SyntheticWorkspace::kWidth;
constexpr int kHeight = SyntheticWorkspace::kHeight;

// With depth of the second and normals of the third image, "v1.png" and
// "left/v2.png".
class RefinePriorsTest : public RefineWorkspaceTest {
 protected:
  void SetUp() override {
    RefineWorkspaceTest::SetUp();
    std::filesystem::create_directories(priors_ / "left");
    WriteDepth(1.f);
    WriteText(priors_ / "left/v2.normal.pfm",
              PfmBytes(4, 3, 3, std::vector<float>(36, -0.5f), true));
  }

  void WriteDepth(float depth, int width = 8, int height = 6) const {
    WriteText(priors_ / "v1.png.pfm",
              PfmBytes(width,
                       height,
                       1,
                       std::vector<float>(static_cast<size_t>(width) *
                                              static_cast<size_t>(height),
                                          depth),
                       true));
  }
  WorkspaceRefineOptions WithPriors() const {
    WorkspaceRefineOptions options = Options(root_);
    options.prior_path = priors_;
    return options;
  }
  static int IndexOf(const Workspace& workspace, const std::string& name) {
    return workspace.Model().IndexOf(name);
  }

  const std::filesystem::path priors_ = folder_.Path() / "priors";
};

TEST_F(RefinePriorsTest, ViewsHaveTheirPriors) {
  Workspace workspace(root_, MapType::kGeometric);
  const int with_depth = IndexOf(workspace, "v1.png");
  const int with_normals = IndexOf(workspace, "left/v2.png");
  const ViewData without = LoadView(workspace, with_depth);
  EXPECT_EQ(without.prior, nullptr);
  workspace.UsePriors(priors_, PriorType::kRelative);
  const ViewData view = LoadView(workspace, with_depth);
  ASSERT_NE(view.prior, nullptr);
  EXPECT_EQ(view.prior->type, PriorType::kRelative);
  EXPECT_EQ(view.prior->values.Width(), 8);
  EXPECT_EQ(view.prior->values(7, 5), 1.f);
  EXPECT_TRUE(view.prior->normals.Empty());
  // However it is reduced.
  EXPECT_EQ(ReduceView(view, 2).prior, view.prior);
  const ViewData reduced = LoadReducedView(workspace, with_depth, 32);
  ASSERT_NE(reduced.prior, nullptr);
  EXPECT_EQ(reduced.prior->values.Width(), 8);
  const ViewData other = LoadView(workspace, with_normals);
  ASSERT_NE(other.prior, nullptr);
  EXPECT_TRUE(other.prior->values.Empty());
  EXPECT_LT(other.prior->normals(3, 2).z, -0.57f);
  EXPECT_EQ(LoadView(workspace, IndexOf(workspace, "v0.png")).prior, nullptr);
  workspace.UsePriors({}, PriorType::kAuto);
  EXPECT_EQ(LoadView(workspace, with_depth).prior, nullptr);
}

TEST_F(RefinePriorsTest, TellsOfHowManyImagesThereArePriors) {
  EXPECT_EQ(Refine().num_priors, std::nullopt);
  EXPECT_FALSE(Manifest()["runtime"].contains("depth_priors"));
  const Tree without = MapsOf(root_);
  const RunSummary summary = Refine(WithPriors());
  EXPECT_EQ(summary.num_priors, 2);
  EXPECT_EQ(Manifest()["runtime"]["depth_priors"], "2");
  // One prior has a constant depth, the other one has none.
  EXPECT_EQ(summary.counts.at(kPriorsDropped), 2);
  EXPECT_FALSE(summary.counts.contains(kPriorsUsed));
  ExpectSameFiles(without, MapsOf(root_));
  std::map<std::string, std::string> notes;
  const nlohmann::json manifest = Manifest();
  for (const auto& image : manifest["images"]) {
    notes[image["image"]] = image["note"];
  }
  EXPECT_EQ(notes["v0.png"], "");
  EXPECT_THAT(notes["left/v2.png"], testing::StartsWith("normals not used: "));
  EXPECT_THAT(notes["v1.png"],
              testing::AllOf(testing::StartsWith("depth prior not used: as "),
                             testing::HasSubstr("explains only 0 %")));
}

TEST_F(RefinePriorsTest, NumbersThatStandForNoDepthAreNone) {
  std::vector<float> values(48, 1e4f);
  std::fill_n(values.begin(), 30, 2.f);
  WriteText(priors_ / "v1.png.pfm", PfmBytes(8, 6, 1, values, true));
  EXPECT_THAT(WarningsOf(WithPriors(), 4),
              testing::HasSubstr((priors_ / "v1.png.pfm").string() +
                                 ": many depths are 10000"));
  Workspace workspace(root_, MapType::kGeometric);
  workspace.UsePriors(priors_, PriorType::kAuto);
  const Image<float> read =
      workspace.ReadPrior(IndexOf(workspace, "v1.png"))->values;
  EXPECT_EQ(read(0, 0), 2.f);
  EXPECT_EQ(read(7, 5), 0.f);
}

TEST_F(RefinePriorsTest, MasksHidePriors) {
  Workspace workspace(root_, MapType::kGeometric);
  workspace.UsePriors(priors_, PriorType::kAuto);
  const std::filesystem::path masks = folder_.Path() / "masks";
  for (const char* name : {"v1.png.png", "left/v2.png.png"}) {
    WriteMask(masks / name, kWidth, kHeight, [](int x, int) {
      return x < kWidth / 2;
    });
  }
  workspace.UseMasks(masks);
  for (const int max_side : {kWidth, 32}) {
    const ViewData depth =
        LoadReducedView(workspace, IndexOf(workspace, "v1.png"), max_side);
    EXPECT_EQ(depth.prior->values(3, 2), 0.f);
    EXPECT_EQ(depth.prior->values(4, 2), 1.f);
    const ViewData normals =
        LoadReducedView(workspace, IndexOf(workspace, "left/v2.png"), max_side);
    EXPECT_TRUE(normals.prior->normals(1, 1) == Vec3f{});
    EXPECT_LT(normals.prior->normals(2, 1).z, 0.f);
  }
}

TEST_F(RefinePriorsTest, RefinesAgainWherePriorsHaveChanged) {
  Refine();
  const auto has_changed = testing::HasSubstr("the depth prior of ");
  EXPECT_THAT(WarningsOf(WithPriors(), 4),
              testing::HasSubstr("v0.png and 3 more: refined again, since the "
                                 "depth prior of left/v2.png and 1 other input "
                                 "have changed\n"));
  EXPECT_EQ(WarningsOf(WithPriors(), 0), "");
  WriteDepth(2.f, 16, 12);
  EXPECT_THAT(WarningsOf(WithPriors(), 4), has_changed);
  WorkspaceRefineOptions metric = WithPriors();
  metric.prior_type = PriorType::kMetric;
  EXPECT_THAT(WarningsOf(metric, 4), has_changed);
  EXPECT_EQ(WarningsOf(metric, 0), "");
  EXPECT_THAT(WarningsOf(Options(root_), 4), has_changed);
  ExpectSameFiles(MapsOf(root_), RefinedInOneGo());
}

TEST_F(RefinePriorsTest, RefusesPriorsThatDoNotFitBeforeAnythingIsChanged) {
  const std::filesystem::path file = priors_ / "v1.png.pfm";
  const std::string good = ReadText(file);
  WriteDepth(1.f, 6, 8);
  ExpectRefusal(ErrorCode::kMismatch,
                {file.string() + ": the depth prior has 6 x 8 pixels",
                 "undistorted image of 96 x 72"},
                WithPriors());
  WriteText(file, good.substr(0, good.size() - 1));
  ExpectRefusal(ErrorCode::kCorrupt, {file.string()}, WithPriors());
  WriteText(file, good);
  WriteText(priors_ / "v1.npy", "");
  ExpectRefusal(
      ErrorCode::kMismatch,
      {file.string(), (priors_ / "v1.npy").string(), "of the image v1.png"},
      WithPriors());
  std::filesystem::remove(priors_ / "v1.npy");
  std::filesystem::remove(file);
  std::filesystem::create_directories(file);
  ExpectRefusal(ErrorCode::kIo, {file.string()}, WithPriors());
}

TEST_F(RefinePriorsTest, RefusesFoldersWithoutPriors) {
  WorkspaceRefineOptions options = WithPriors();
  options.prior_path = root_ / "images";
  ExpectRefusal(ErrorCode::kBadOption,
                {"is the folder of the images", "depth priors", "prior_path"},
                options);
  options.prior_path = root_ / "stereo";
  ExpectRefusal(ErrorCode::kNotFound,
                {"holds no depth prior of any image",
                 "v0.png would be v0.png.npy or v0.npy",
                 "prior_path"},
                options);
  options.prior_path = folder_.Path() / "none";
  ExpectRefusal(
      ErrorCode::kNotFound, {"no such folder of depth priors"}, options);
  options = WithPriors();
  RefineOptions alone;
  alone.scene_planes = false;
  ExpectError(ErrorCode::kBadOption, {"prior_path", "scene_planes"}, [&] {
    Refine(options, alone);
  });
  options.prior_path.clear();
  options.prior_type = PriorType::kMetric;
  ExpectRefusal(ErrorCode::kBadOption, {"prior_type", "prior_path"}, options);
}

}  // namespace
}  // namespace tsar
