// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/stage_options.h"

#include "colmap_tsar/compose/compose_image.h"
#include "colmap_tsar/scene/scene_options.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <utility>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(StageOptions, KeyRandomNumbersByImageAndSeed) {
  RefineOptions options;
  options.seed = 7;
  const GroupPlaneOptions ransac =
      MakeRegionPlaneOptions(options, 1.0, 3).ransac;
  EXPECT_EQ(ransac.image_id, 3u);
  EXPECT_EQ(ransac.seed, 7u);
}

// Settings that only the paper's preset has reach their stage.
TEST(StageOptions, OfThePaper) {
  const RefineOptions paper = PresetOptions(RefinePreset::kPaper);
  const RegionPlaneOptions regions = MakeRegionPlaneOptions(paper, 1.0, 1);
  EXPECT_EQ(regions.max_planes, 1);
  EXPECT_FALSE(regions.use_core);
}

TEST(StageOptions, DepthsMoveOntoTheirPlanesWithinTheSpreadOfDepths) {
  ViewEvidence evidence;
  // Too little to resolve, three standard deviations, and what carries no
  // plane.
  const std::pair<float, float> spread_of_noise[] = {
      {0.01f, 0.3f}, {0.2f, 0.6f}, {1.f, 1.2f}};
  for (const auto& [noise, spread] : spread_of_noise) {
    evidence.noise = noise;
    EXPECT_FLOAT_EQ(MakeCompositionOptions({{&evidence, {}}}).on_plane, spread);
  }
}

}  // namespace
}  // namespace tsar
