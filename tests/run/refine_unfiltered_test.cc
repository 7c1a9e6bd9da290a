// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tests/run/refine_workspace_fixture.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

// Without the geometric maps, those that nothing was filtered out of.
class RefineUnfilteredTest : public RefineWorkspaceTest {
 protected:
  void SetUp() override {
    RefineWorkspaceTest::SetUp();
    for (int view = 0; view < 4; ++view) {
      RemoveMaps(view, MapType::kGeometric);
    }
  }

  static RefineOptions Distrusting() {
    RefineOptions options;
    options.distrust_unmatched = true;
    return options;
  }

  const RefineOptions distrusting_ = Distrusting();

  int64_t CountRightDepthsOfTheBareWall() const {
    int64_t num_right = 0;
    for (int view = 0; view < 4; ++view) {
      const Image<float> depth =
          ReadDepthMap(Paths(view, MapType::kPhotometric).depth);
      for (int y = 0; y < depth.Height(); ++y) {
        for (int x = 0; x < depth.Width(); ++x) {
          num_right += SyntheticWorkspace::IsBare(view, x, y) &&
                               std::abs(depth(x, y) - 5.f) < 0.05f
                           ? 1
                           : 0;
        }
      }
    }
    return num_right;
  }
};

TEST_F(RefineUnfilteredTest, DepthsOfTheBareWallDoNotCount) {
  const RunSummary with_them = Refine();
  EXPECT_EQ(with_them.num_refined, 4);
  EXPECT_EQ(with_them.counts.at("depth_before"), 4 * 96 * 72);
  const int64_t num_right_with_them = CountRightDepthsOfTheBareWall();
  // Another option, so all is done again.
  const RunSummary summary = Refine(Options(root_), distrusting_);
  EXPECT_EQ(summary.num_refined, 4);
  EXPECT_LT(summary.counts.at("depth_before"), 4 * 96 * 72);
  EXPECT_GE(CountRightDepthsOfTheBareWall(), num_right_with_them);
  EXPECT_EQ(Refine(Options(root_), distrusting_).num_skipped, 4);
}

TEST_F(RefineUnfilteredTest, AViewMayLoseAllItsDepths) {
  ASSERT_TRUE(cv::imwrite((root_ / "images/v0.png").string(),
                          cv::Mat(72, 96, CV_8UC3, cv::Scalar::all(200))));
  const RunSummary summary = Refine(Options(root_), distrusting_);
  EXPECT_EQ(summary.num_refined, 3);
  ASSERT_EQ(summary.kept.size(), 1u);
  EXPECT_EQ(summary.kept[0].name, "v0.png");
  const Image<float> depth =
      ReadDepthMap(Paths(1, MapType::kPhotometric).depth);
  EXPECT_GT(std::count_if(
                depth.begin(), depth.end(), [](float z) { return z > 0.f; }),
            3000);
}

TEST_F(RefineUnfilteredTest, AllViewsMayLoseAllTheirDepths) {
  for (const std::string& name : SyntheticWorkspace::Names()) {
    ASSERT_TRUE(cv::imwrite((root_ / "images" / name).string(),
                            cv::Mat(72, 96, CV_8UC3, cv::Scalar::all(200))));
  }
  for (const bool scene_planes : {true, false}) {
    RefineOptions options = distrusting_;
    options.scene_planes = scene_planes;
    const RunSummary summary = Refine(Options(root_), options);
    EXPECT_EQ(summary.num_refined, 0);
    EXPECT_EQ(summary.kept.size(), 4u);
  }
}

}  // namespace
}  // namespace tsar
