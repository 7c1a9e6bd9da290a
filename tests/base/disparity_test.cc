// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/disparity.h"

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

Camera PlaceAt(double x) {
  Camera camera = SyntheticCamera(kPaperSize, 2000, 3000.0);
  camera.translation = {-x, 0.0, 0.0};
  return camera;
}

TEST(DisparityScale, IsFocalLengthTimesBaselineOverDepth) {
  const DisparityScale scale =
      ComputeDisparityScale(PlaceAt(0.0), {PlaceAt(0.5)});
  EXPECT_FLOAT_EQ(scale.ToDisparity(3.f), 500.f);
}

TEST(DisparityScale, AveragesTheFourShortestBaselines) {
  const DisparityScale scale = ComputeDisparityScale(PlaceAt(0.0),
                                                     {PlaceAt(100.0),
                                                      PlaceAt(4.0),
                                                      PlaceAt(-1.0),
                                                      PlaceAt(2.0),
                                                      PlaceAt(-3.0)});
  EXPECT_FLOAT_EQ(scale.ToDisparity(1.f), 3000.f * 2.5f);
}

TEST(DisparityScale, LeavesOutSourcesAtTheSamePlace) {
  const DisparityScale scale =
      ComputeDisparityScale(PlaceAt(0.0), {PlaceAt(0.0), PlaceAt(2.0)});
  EXPECT_FLOAT_EQ(scale.ToDisparity(1.f), 6000.f);
}

TEST(DisparityScale, DoesNotDependOnTheMapsSize) {
  const Camera reference = PlaceAt(0.0);
  const float full =
      ComputeDisparityScale(reference, {PlaceAt(0.5)}).ToDisparity(3.f);
  for (const int divisor : {2, 4, 10}) {
    const Camera reduced = reference.Resized(reference.width / divisor,
                                             reference.height / divisor);
    EXPECT_NEAR(ComputeDisparityScale(reduced, {PlaceAt(0.5)}).ToDisparity(3.f),
                full,
                1e-3f * full);
  }
}

TEST(DisparityScale, DoesNotDependOnTheScenesScale) {
  const float disparity =
      ComputeDisparityScale(PlaceAt(0.0), {PlaceAt(0.5)}).ToDisparity(3.f);
  EXPECT_FLOAT_EQ(
      ComputeDisparityScale(PlaceAt(0.0), {PlaceAt(500.0)}).ToDisparity(3000.f),
      disparity);
}

TEST(DisparityScale, IsZeroWithoutABaseline) {
  EXPECT_EQ(ComputeDisparityScale(PlaceAt(0.0), {}).factor, 0.f);
  EXPECT_EQ(ComputeDisparityScale(PlaceAt(0.0), {PlaceAt(0.0)}).factor, 0.f);
}

TEST(DisparityScale, DepthErrorIsOnePixelOfTheMapWithinItsBounds) {
  // f b = 1500, so one pixel is 1 / 150 of the depth 10.
  const Camera reference = PlaceAt(0.0);
  const DisparityScale scale = ComputeDisparityScale(reference, {PlaceAt(0.5)});
  EXPECT_FLOAT_EQ(scale.RelativeDepthError(10.f), 10.f / 1500.f);
  EXPECT_FLOAT_EQ(scale.RelativeDepthError(0.1f), 0.002f);
  EXPECT_FLOAT_EQ(scale.RelativeDepthError(1e4f), 0.02f);
  // Half the map: a pixel is twice as much.
  const DisparityScale half = ComputeDisparityScale(
      reference.Resized(reference.width / 2, reference.height / 2),
      {PlaceAt(0.5)});
  EXPECT_NEAR(half.RelativeDepthError(10.f), 20.f / 1500.f, 1e-6f);
}

}  // namespace
}  // namespace tsar
