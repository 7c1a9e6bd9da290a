// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/stage_options.h"

#include "colmap_tsar/compose/compose_image.h"
#include "colmap_tsar/scene/scene_options.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(StageOptions, KeyRandomNumbersByImageAndSeed) {
  RefineOptions options;
  options.seed = 7;
  const GroupPlaneOptions superpixels =
      MakeCorrelationOptions(options, 3).planes.ransac;
  const GroupPlaneOptions regions =
      MakeRegionPlaneOptions(options, 1.0, 3).ransac;
  for (const GroupPlaneOptions& ransac : {superpixels, regions}) {
    EXPECT_EQ(ransac.image_id, 3u);
    EXPECT_EQ(ransac.seed, 7u);
  }
}

// What is printed in the paper and no default reaches its stage.
TEST(StageOptions, OfThePaperAsPrinted) {
  const RefineOptions strict = PresetOptions(RefinePreset::kPaperStrict);
  EXPECT_TRUE(MakeConfidenceOptions(strict).use_ratio);
  const CorrelationOptions correlation = MakeCorrelationOptions(strict, 1);
  EXPECT_TRUE(correlation.spread_medians);
  EXPECT_TRUE(correlation.readmit_filtered);
  EXPECT_TRUE(correlation.small_windows);
  EXPECT_TRUE(correlation.pixel_distances);
  EXPECT_FLOAT_EQ(correlation.planes.loose_tolerance, 0.005f);
  EXPECT_EQ(MakeHoughOptions(strict, 1.0).min_length_share, 0.f);
  const RegionPlaneOptions regions = MakeRegionPlaneOptions(strict, 1.0, 1);
  EXPECT_EQ(regions.max_planes, 1);
  EXPECT_FALSE(regions.use_core);
  EXPECT_EQ(regions.rim_width, 0);
  EXPECT_TRUE(std::isinf(regions.max_extrapolation));
  EXPECT_TRUE(std::isinf(regions.max_boundary_error));
  EXPECT_EQ(regions.min_rim_share, 0.f);
}

TEST(StageOptions, OfThePaperReachNothingByDefault) {
  EXPECT_FALSE(MakeConfidenceOptions({}).use_ratio);
  const CorrelationOptions correlation = MakeCorrelationOptions({}, 1);
  EXPECT_FALSE(correlation.spread_medians);
  EXPECT_FALSE(correlation.small_windows);
  EXPECT_FALSE(correlation.pixel_distances);
  EXPECT_EQ(correlation.planes.loose_tolerance, 0.f);
  EXPECT_GT(MakeHoughOptions({}, 1.0).min_length_share, 0.f);
  const RegionPlaneOptions regions = MakeRegionPlaneOptions({}, 1.0, 1);
  EXPECT_GT(regions.rim_width, 0);
  EXPECT_EQ(regions.max_extrapolation, RegionPlaneOptions().max_extrapolation);
  EXPECT_FLOAT_EQ(regions.max_boundary_error, 0.02f);
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

TEST(MeasuringOptions, LeaveEveryPixelItsDepth) {
  const RefineOptions measuring =
      MeasuringOptions(PresetOptions(RefinePreset::kPaperStrict));
  EXPECT_FALSE(measuring.spread_medians);
  EXPECT_FALSE(measuring.fill_before_regions);
  EXPECT_TRUE(measuring.cost_ratio);
}

}  // namespace
}  // namespace tsar
