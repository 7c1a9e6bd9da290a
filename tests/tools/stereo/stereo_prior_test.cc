// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/stereo/stereo_workspace.h"

#include <cmath>
#include <cstring>
#include <vector>

#include "tests/tools/stereo/stereo_workspace_fixture.h"

namespace tsar {
namespace {

constexpr double kDepth = SyntheticWorkspace::kDepth;

// What the maps say about the bare part of the wall.
struct BareWall {
  int num_found = 0;
  int num_right = 0;
  int num_with_evidence = 0;
};

BareWall LookAtBareWall(const std::filesystem::path& root) {
  BareWall bare;
  const Workspace workspace(root, MapType::kGeometric);
  for (int view = 0; view < 4; ++view) {
    const int image =
        workspace.Model().IndexOf(SyntheticWorkspace::Names()[view]);
    const Image<float> depth =
        workspace.ReadOriginalMaps(image, MapType::kGeometric).depth;
    const PlanarMap costs =
        ReadPlanarMap(workspace.CostPath(image, MapType::kGeometric));
    for (int y = 0; y < depth.Height(); ++y) {
      for (int x = 0; x < depth.Width(); ++x) {
        bool is_bare = true;
        for (const int dx : {-3, 0, 3}) {
          for (const int dy : {-3, 0, 3}) {
            is_bare =
                is_bare && SyntheticWorkspace::IsBare(view, x + dx, y + dy);
          }
        }
        if (is_bare && depth(x, y) > 0.f) {
          ++bare.num_found;
          bare.num_right += std::abs(depth(x, y) - kDepth) < 0.01 * kDepth;
          bare.num_with_evidence +=
              costs.values[depth.View().Index(x, y)] < 2.f;
        }
      }
    }
  }
  return bare;
}

TEST_F(StereoWorkspaceTest, ThePriorFillsTheBareWallAndSaysSo) {
  options_.max_image_size = StereoOptions().max_image_size;
  options_.planar_prior = false;
  Run();
  const BareWall without = LookAtBareWall(root_);
  options_.planar_prior = true;
  Run(/*overwrite=*/true);
  const BareWall with = LookAtBareWall(root_);
  EXPECT_EQ(without.num_with_evidence, without.num_found);
  EXPECT_GT(with.num_right, 3 * without.num_right);
  // Some triangles have a vertex in front of the wall.
  EXPECT_GT(with.num_right, 0.65 * with.num_found);
  EXPECT_EQ(with.num_with_evidence, without.num_with_evidence);
}

// What tsar_refine reads is the same: the prior changes nothing for it.
// In the files, where what was measured may have no defined cost, and as
// tsar_refine reads them.
TEST_F(StereoWorkspaceTest, ThePriorLeavesWhatWasMeasuredAsItIs) {
  struct Result {
    std::vector<DepthNormal> maps;
    std::vector<std::vector<float>> costs;
    std::vector<ViewData> views;
  };
  const auto run = [&](bool planar_prior) {
    options_.planar_prior = planar_prior;
    Run(/*overwrite=*/true);
    const Workspace workspace(root_, MapType::kGeometric);
    Result result;
    for (int image = 0; image < 4; ++image) {
      result.maps.push_back(
          workspace.ReadOriginalMaps(image, MapType::kGeometric));
      result.costs.push_back(
          ReadPlanarMap(workspace.CostPath(image, MapType::kGeometric)).values);
      result.views.push_back(LoadView(workspace, image));
    }
    return result;
  };
  const auto same = [](const auto& first, const auto& second) {
    return first.NumPixels() == second.NumPixels() &&
           std::memcmp(first.Data(),
                       second.Data(),
                       first.NumPixels() * sizeof(*first.Data())) == 0;
  };
  options_.max_image_size = StereoOptions().max_image_size;
  // The wide window measures where the cost's smaller one has no texture.
  for (const int window_radius : {StereoOptions().window_radius, 15}) {
    options_.window_radius = window_radius;
    const Result without = run(false);
    const Result with = run(true);
    int num_filled = 0;
    for (size_t image = 0; image < 4; ++image) {
      const DepthNormal& before = without.maps[image];
      const DepthNormal& after = with.maps[image];
      const size_t num_pixels = before.depth.NumPixels();
      ASSERT_EQ(after.depth.NumPixels(), num_pixels);
      for (size_t i = 0; i < num_pixels; ++i) {
        if (!(before.depth.Data()[i] > 0.f)) {
          num_filled += after.depth.Data()[i] > 0.f ? 1 : 0;
          continue;
        }
        ASSERT_EQ(after.depth.Data()[i], before.depth.Data()[i]) << i;
        ASSERT_TRUE(after.normal.Data()[i] == before.normal.Data()[i]) << i;
        for (const size_t channel : {size_t{0}, num_pixels}) {
          ASSERT_EQ(with.costs[image][channel + i],
                    without.costs[image][channel + i])
              << i;
        }
      }
      EXPECT_TRUE(same(with.views[image].depth, without.views[image].depth));
      EXPECT_TRUE(same(with.views[image].normal, without.views[image].normal));
      EXPECT_TRUE(
          same(with.views[image].min_cost, without.views[image].min_cost));
      EXPECT_TRUE(same(with.views[image].second_cost,
                       without.views[image].second_cost));
    }
    EXPECT_GT(num_filled, 20) << window_radius;
  }
}

}  // namespace
}  // namespace tsar
