// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/surface_samples.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/synthetic_observations.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// Rays do not meet it far from the middle.
CurvedSurface Bowl() {
  return {0.1f, -0.2f, 0.5f, {0.25f, 0.03f, -0.02f, -0.04f, 0.01f, -0.03f}};
}

std::vector<Vec3f> DrawRays(int count) {
  Philox random(3, 0, 0);
  std::vector<Vec3f> rays;
  for (int i = 0; i < count; ++i) {
    rays.push_back({static_cast<float>(NextNormal(&random)),
                    static_cast<float>(NextNormal(&random)),
                    1.f});
  }
  return rays;
}

std::vector<float> Depths(const CurvedSurface& surface,
                          const RaySamples& rays,
                          const SampleRange& range) {
  std::vector<float> depths(range.PaddedCount());
  ComputeDepths(surface, rays, range, depths.data());
  depths.resize(range.count);
  return depths;
}

std::vector<float> Differences(const CurvedSurface& surface,
                               const DepthSamples& samples,
                               const SampleRange& range) {
  std::vector<float> differences(range.PaddedCount());
  ComputeDifferences(surface, samples, range, differences.data());
  differences.resize(range.count);
  return differences;
}

TEST(SurfaceSamplesTest, DepthsAreThoseOfTheTangents) {
  const CurvedSurface surface = Bowl();
  const std::vector<Vec3f> rays = DrawRays(203);
  RaySamples samples;
  const std::vector<float> depths = Depths(surface, samples, samples.Add(rays));
  ASSERT_EQ(depths.size(), rays.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    // To the last bit.
    EXPECT_EQ(depths[i], surface.TangentAt(rays[i]).Depth(rays[i]));
  }
  const auto num_missed = std::count(depths.begin(), depths.end(), 0.f);
  EXPECT_GT(num_missed, 20);
  EXPECT_LT(num_missed, 183);
}

TEST(SurfaceSamplesTest, RangesOfAllLengthsStandBesideEachOther) {
  const CurvedSurface surface = Bowl();
  RaySamples together;
  std::vector<SampleRange> ranges;
  for (int count = 0; count < 10; ++count) {
    ranges.push_back(together.Add(DrawRays(count)));
  }
  for (int count = 0; count < 10; ++count) {
    EXPECT_EQ(ranges[count].begin % SampleRange::kAlignment, 0u);
    EXPECT_EQ(ranges[count].count, static_cast<size_t>(count));
    RaySamples alone;
    EXPECT_EQ(Depths(surface, together, ranges[count]),
              Depths(surface, alone, alone.Add(DrawRays(count))));
  }
}

TEST(SurfaceSamplesTest, DifferencesAreInPixelsOfDisparity) {
  CurvedSurface plane;
  plane.coefficients[0] = 0.25f;
  plane.coefficients[1] = 0.1f;
  // At 5 one pixel is 1 % of the depth, at 1 the least, 0.2 %.
  DepthSamples samples;
  const SampleRange none = samples.Add({}, {0.002f});
  const SampleRange range = samples.Add({{{0.f, 0.f, 5.f}, 1.f},
                                         {{0.f, 0.3f, 1.f}, 1.f},
                                         {{-2.4f, 0.f, 100.f}, 1.f},
                                         {{-2.6f, 0.f, 4.f}, 1.f},
                                         {{0.f, 0.f, 4.f}, 1.f}},
                                        {0.002f});
  EXPECT_TRUE(Differences(plane, samples, none).empty());
  const std::vector<float> differences = Differences(plane, samples, range);
  ASSERT_EQ(differences.size(), 5u);
  EXPECT_NEAR(differences[0], 1.f / 0.05f, 1e-4f);
  EXPECT_NEAR(differences[1], 3.f / 0.002f, 1e-2f);
  EXPECT_NEAR(differences[2], 0.f, 1e-3f);
  EXPECT_EQ(differences[3], INFINITY);
  EXPECT_NEAR(differences[4], 0.f, 1e-4f);
}

}  // namespace
}  // namespace tsar
