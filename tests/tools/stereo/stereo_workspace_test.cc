// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_workspace.h"

#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cmath>

#include "tests/tools/stereo/stereo_workspace_fixture.h"

namespace tsar {
namespace {

constexpr double kDepth = SyntheticWorkspace::kDepth;

TEST_F(StereoWorkspaceTest, FindsTheWallWhereItHasTexture) {
  options_.max_image_size = StereoOptions().max_image_size;
  const StereoSummary summary = Run();
  EXPECT_EQ(summary.num_images, 4);
  EXPECT_EQ(summary.num_skipped, 0);
  EXPECT_TRUE(summary.without_sources.empty());
  const Workspace workspace(root_, MapType::kGeometric);
  int num_textured = 0;
  int num_found = 0;
  int num_right = 0;
  for (int view = 0; view < 4; ++view) {
    const int image =
        workspace.Model().IndexOf(SyntheticWorkspace::Names()[view]);
    const DepthNormal dense =
        workspace.ReadOriginalMaps(image, MapType::kPhotometric);
    const DepthNormal filtered =
        workspace.ReadOriginalMaps(image, MapType::kGeometric);
    const std::vector<float> costs =
        ReadCosts(workspace.Paths(image, MapType::kGeometric).cost);
    ASSERT_EQ(costs.size(), 2 * filtered.depth.NumPixels());
    const Intrinsics intrinsics =
        workspace.Model().images[image].camera.GetIntrinsics();
    for (int y = 8; y < SyntheticWorkspace::kHeight - 8; ++y) {
      for (int x = 8; x < SyntheticWorkspace::kWidth - 8; ++x) {
        EXPECT_GT(dense.depth(x, y), 0.f);
        EXPECT_GE(dense.depth(x, y), 0.999 * options_.depth_min);
        EXPECT_LE(dense.depth(x, y), 1.001 * options_.depth_max);
        const float z = filtered.depth(x, y);
        const size_t i = static_cast<size_t>(y) * SyntheticWorkspace::kWidth +
                         static_cast<size_t>(x);
        const float cost = costs[i];
        EXPECT_TRUE(cost >= 0.f && cost <= 2.f);
        EXPECT_LE(cost, costs[i + filtered.depth.NumPixels()]);
        if (z > 0.f) {
          EXPECT_LT(Dot(filtered.normal(x, y), intrinsics.Ray(x, y)), 0.f);
        }
        bool is_textured = true;
        for (const int dx : {-6, 0, 6}) {
          for (const int dy : {-6, 0, 6}) {
            is_textured = is_textured &&
                          !SyntheticWorkspace::IsBare(view, x + dx, y + dy);
          }
        }
        if (is_textured) {
          ++num_textured;
          num_found += z > 0.f;
          num_right += std::abs(z - kDepth) < 0.01 * kDepth;
        }
      }
    }
  }
  EXPECT_GT(num_textured, 4000);
  EXPECT_GT(num_found, 0.9 * num_textured);
  EXPECT_GT(num_right, 0.97 * num_found);
}

TEST_F(StereoWorkspaceTest, MakesSmallPhotometricMapsAloneIfToldSo) {
  options_.geom_consistency = false;
  Run();
  const Workspace workspace(root_, MapType::kPhotometric);
  for (int image = 0; image < 4; ++image) {
    EXPECT_FALSE(workspace.HasMaps(image, MapType::kGeometric));
    const MapSize size =
        ReadMapSize(workspace.Paths(image, MapType::kPhotometric).depth);
    EXPECT_EQ(size.width, kMapWidth);
    EXPECT_EQ(size.height, kMapHeight);
  }
}

TEST_F(StereoWorkspaceTest, ThreadsDoNotMatter) {
  Run();
  const auto first = Maps();
  options_.num_sources = 19;  // More than there are: the same sources.
  Run(/*overwrite=*/true, /*num_threads=*/5);
  EXPECT_TRUE(Maps() == first);
}

TEST_F(StereoWorkspaceTest, RefusesWhatCannotBeMatchedAndChangesNothing) {
  MakeSyntheticWorkspace(root_);
  options_.depth_min = options_.depth_max = -1;
  ExpectRefused(ErrorCode::kNotFound, "depth_min", true);
  const std::filesystem::path path = root_ / "images/left/v2.png";
  const std::string photo = ReadText(path);
  WriteText(path, photo.substr(0, photo.size() / 10));
  ExpectRefused(ErrorCode::kCorrupt, "left/v2.png: the image is damaged", true);
  std::filesystem::remove(path);
  ExpectRefused(ErrorCode::kNotFound, "left/v2.png", true);
}

TEST(StereoOptions, RejectsDepthsThatMakeNoRange) {
  for (const auto& [min, max] :
       {std::pair{1.0, -1.0}, {-1.0, 1.0}, {2.0, 1.0}, {0.0, 1.0}}) {
    StereoOptions options;
    options.depth_min = min;
    options.depth_max = max;
    EXPECT_THROW(options.Check(), Error) << min << " " << max;
  }
  StereoOptions options;
  options.max_image_size = 0;
  EXPECT_THROW(options.Check(), Error);
}

TEST(StereoOptions, TextTellsEveryValueApart) {
  StereoOptions other;
  other.filter_min_ncc = 0.1000001;
  EXPECT_NE(other.Text(), StereoOptions().Text());
}

}  // namespace
}  // namespace tsar
