// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/io/masks_and_labels.h"
#include "colmap_tsar/run/load_view.h"

#include <cmath>
#include <functional>

#include "tests/run/refine_workspace_fixture.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

constexpr int kWidth = SyntheticWorkspace::kWidth;
constexpr int kHeight = SyntheticWorkspace::kHeight;

using Segment = std::function<int(int x, int y)>;

// With label images of all but the last image, at half their size.
class RefineLabeledTest : public RefineWorkspaceTest {
 protected:
  void SetUp() override {
    RefineWorkspaceTest::SetUp();
    WriteLabels(&InTwoHalves);
  }

  static int InTwoHalves(int x, int /*y*/) { return x < 30 ? 1 : 2; }
  void WriteLabels(const Segment& segment) const {
    for (const char* name : {"v0.png.png", "v1.png", "left/v2.png"}) {
      WriteLabels(name, segment);
    }
  }
  void WriteLabels(const std::filesystem::path& name,
                   const Segment& segment) const {
    cv::Mat_<ushort> pixels(kHeight / 2, kWidth / 2);
    for (int y = 0; y < pixels.rows; ++y) {
      for (int x = 0; x < pixels.cols; ++x) {
        pixels(y, x) = static_cast<ushort>(segment(x, y));
      }
    }
    std::filesystem::create_directories((regions_ / name).parent_path());
    ASSERT_TRUE(cv::imwrite((regions_ / name).string(), pixels));
  }
  WorkspaceRefineOptions Labeled(const std::filesystem::path& root) const {
    WorkspaceRefineOptions options = Options(root);
    options.region_path = regions_;
    return options;
  }
  WorkspaceRefineOptions Labeled() const { return Labeled(root_); }
  void Redraw() const {
    std::filesystem::remove_all(root_);
    MakeSyntheticWorkspace(root_);
  }
  std::string WarningsOf(const WorkspaceRefineOptions& options,
                         int num_refined) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(Refine(options).num_refined, num_refined);
    return testing::internal::GetCapturedStderr();
  }
  // The share of pixels of all images with the depth of the wall.
  double ShareOfRight() const {
    int num_right = 0;
    for (int view = 0; view < 4; ++view) {
      for (const float depth : ReadDepthMap(Paths(view).depth)) {
        num_right +=
            std::abs(depth - SyntheticWorkspace::kDepth) < 0.05 ? 1 : 0;
      }
    }
    return num_right / (4.0 * kWidth * kHeight);
  }

  const std::filesystem::path regions_ = folder_.Path() / "regions";
};

TEST_F(RefineLabeledTest, ImagesOfTheWorkspaceHaveTheirSegments) {
  Workspace workspace(root_, MapType::kGeometric);
  EXPECT_TRUE(LoadView(workspace, 0).segments.Empty());
  EXPECT_EQ(workspace.CheckLabels(0), 0);
  workspace.UseLabelImages(regions_);
  for (int image = 0; image < 4; ++image) {
    const bool has_labels = !workspace.LabelImagePath(image).empty();
    const std::string& name = workspace.Model().images[image].name;
    EXPECT_EQ(has_labels, name != "v3.png");
    EXPECT_EQ(workspace.CheckLabels(image),
              has_labels ? kWidth / 2 * kHeight / 2 : 0);
    const ViewData whole = LoadView(workspace, image);
    // At a third of the maps' size.
    const ViewData reduced = LoadReducedView(workspace, image, kWidth / 3);
    for (const ViewData* view : {&whole, &reduced}) {
      ASSERT_EQ(view->segments.Width(), has_labels ? kWidth / 2 : 0);
      if (has_labels) {
        EXPECT_EQ(view->segments(29, 5), 1);
        EXPECT_EQ(view->segments(30, 5), 2);
      }
    }
    EXPECT_EQ(ReduceView(whole, 3).segments.HasSizeOf(whole.segments), true);
  }
}

TEST_F(RefineLabeledTest, ImagesWithoutSegmentsAreRefinedAsWithoutLabels) {
  WriteLabels([](int, int) { return 0; });
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    Redraw();
    Refine(Labeled(), refine);
    ExpectSameFiles(MapsOf(root_), RefinedInOneGo(refine));
  }
}

TEST_F(RefineLabeledTest, WrongSegmentsDoNoHarm) {
  Philox random(7, 0, 0);
  const Segment wrong[] = {
      [&](int, int) { return static_cast<int>(random.NextFloat() * 65535); },
      [](int, int) { return 7; },
      [](int x, int y) { return 1 + (x + y) / 9; },
      [](int x, int y) { return x > 20 && y > 9 && x < 37 ? 65535 : 0; }};
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    Redraw();
    Refine(Options(root_), refine);
    const double without = ShareOfRight();
    for (const Segment& segment : wrong) {
      WriteLabels(segment);
      Redraw();
      Refine(Labeled(), refine);
      EXPECT_GT(ShareOfRight(), without - 0.02);
    }
  }
}

TEST_F(RefineLabeledTest, RefinesAgainWhereLabelsHaveChanged) {
  Refine();
  const std::string reason =
      "refined again, since the label image of v1.png has changed";
  // Given, changed, and no longer given; all images have the planes of one
  // scene.
  EXPECT_THAT(WarningsOf(Labeled(), 4), testing::HasSubstr(reason));
  EXPECT_EQ(WarningsOf(Labeled(), 0), "");
  const Tree labeled = MapsOf(root_);
  WriteLabels("v1.png", [](int, int y) { return y; });
  EXPECT_THAT(WarningsOf(Labeled(), 4), testing::HasSubstr(reason + "\n"));
  WriteLabels("v1.png", &InTwoHalves);
  Refine(Labeled());
  ExpectSameFiles(MapsOf(root_), labeled);
  EXPECT_THAT(WarningsOf(Options(root_), 4), testing::HasSubstr(reason));
  ExpectSameFiles(MapsOf(root_), RefinedInOneGo());
}

TEST_F(RefineLabeledTest, ASecondWorkspaceAndShardsSeeTheSameLabels) {
  Refine(Labeled());
  const Tree whole = MapsOf(root_);
  Redraw();
  WorkspaceRefineOptions output = Labeled();
  output.output_path = folder_.Path() / "out";
  Refine(output);
  const Tree maps = MapsOf(output.output_path);
  for (const auto& [name, content] : whole) {
    ASSERT_EQ(maps.count(name), 1u) << name;
    EXPECT_TRUE(maps.at(name) == content) << name << " differs";
  }
  const auto run = [&](RefinePass pass, const Shard& shard) {
    WorkspaceRefineOptions options = Labeled();
    options.pass = pass;
    options.shard = shard;
    Refine(options);
  };
  run(RefinePass::kObserve, {0, 2});
  run(RefinePass::kObserve, {1, 2});
  run(RefinePass::kModel, {});
  run(RefinePass::kCompose, {0, 2});
  WorkspaceRefineOptions without = Options(root_);
  without.pass = RefinePass::kCompose;
  without.shard = {1, 2};
  ExpectError(ErrorCode::kMismatch,
              {"inputs of the run have changed since"},
              [&] { Refine(without); });
  run(RefinePass::kCompose, {1, 2});
  run(RefinePass::kMerge, {});
  ExpectSameFiles(MapsOf(root_), whole);
}

TEST_F(RefineLabeledTest, RefusesLabelsThatDoNotFitBeforeAnythingIsChanged) {
  const std::filesystem::path labels = regions_ / "left/v2.png";
  const std::string png = ReadText(labels);
  ASSERT_TRUE(cv::imwrite(labels.string(), cv::Mat(60, 60, CV_16UC1)));
  ExpectRefusal(ErrorCode::kMismatch,
                {labels.string() + ": the label image has 60 x 60 pixels",
                 "undistorted image of 96 x 72"},
                Labeled());
  ASSERT_TRUE(cv::imwrite(labels.string(), cv::Mat(72, 96, CV_8UC3)));
  ExpectRefusal(ErrorCode::kUnsupported,
                {labels.string() + ": the label image has colors"},
                Labeled());
  WriteText(labels, png.substr(0, png.size() - 20));
  ExpectRefusal(
      ErrorCode::kCorrupt, {labels.string(), "it breaks off"}, Labeled());
  WorkspaceRefineOptions other = Labeled();
  other.region_path = root_ / "images";
  ExpectRefusal(ErrorCode::kBadOption,
                {"is the folder of the images", "region_path"},
                other);
  other.region_path = root_ / "stereo";
  ExpectRefusal(ErrorCode::kNotFound,
                {"holds no label image of any image", "region_path"},
                other);
  other.region_path = root_ / "nowhere";
  ExpectRefusal(ErrorCode::kNotFound,
                {"there is no such folder of label images", "region_path"},
                other);
}

}  // namespace
}  // namespace tsar
