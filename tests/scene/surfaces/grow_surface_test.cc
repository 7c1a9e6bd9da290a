// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/grow_surface.h"

#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include <algorithm>
#include <vector>

#include "tests/scene/surfaces/curved_surfaces_fixture.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// The whole image sees a sphere.
class GrowSurfaceTest : public CurvedSurfacesTest {
 protected:
  GrowSurfaceTest() {
    Measure([](const Vec3f& ray) { return Round(10.f, ray, true); });
    MakeFacets();
    evidence_ = GatherEvidence(inputs_).evidence;
  }

  SurfaceCosts Costs() const {
    return SurfaceCosts({{&evidence_, camera_}}, labeled_, options_);
  }

  ViewEvidence evidence_;
};

void ExpectSame(const GrownSurface& a, const GrownSurface& b) {
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.members, b.members);
  EXPECT_EQ(a.gain, b.gain);
  for (int i = 0; i < FittedSurface::kNumParameters; ++i) {
    EXPECT_EQ(a.fitted.surface.coefficients[i],
              b.fitted.surface.coefficients[i]);
  }
}

TEST_F(GrowSurfaceTest, WhatOtherSeedsFoundOutChangesNothing) {
  const SurfaceCosts costs = Costs();
  SurfaceGrower grower(costs);
  int num_grown = 0;
  for (int seed = 0; seed < kNumSuperpixels; ++seed) {
    const GrownSurface grown = grower.Grow(seed);
    if (seed % 7 == 0) {
      const SurfaceCosts same = Costs();
      ExpectSame(grown, SurfaceGrower(same).Grow(seed));
    }
    num_grown += grown.gain > 0.0 ? 1 : 0;
  }
  EXPECT_GT(num_grown, kNumSuperpixels / 2);
}

TEST_F(GrowSurfaceTest, StaysOutOfWhatWasTakenSince) {
  const SurfaceCosts costs = Costs();
  SurfaceGrower grower(costs);
  const int seed = 4 * kNumColumns + 4;
  const GrownSurface before = grower.Grow(seed);
  std::vector<int> taken;
  for (int s = 0; s < kNumSuperpixels; ++s) {
    if (s % kNumColumns >= 10) {
      taken.push_back(s);
    }
  }
  grower.Take(taken);
  const GrownSurface after = grower.Grow(seed);
  SurfaceGrower fresh(costs);
  fresh.Take(taken);
  ExpectSame(after, fresh.Grow(seed));
  const auto reaches = [](const GrownSurface& grown) {
    return std::any_of(grown.members.begin(), grown.members.end(), [](int s) {
      return s % kNumColumns >= 10;
    });
  };
  ASSERT_GT(before.gain, 0.0);
  EXPECT_TRUE(reaches(before));
  EXPECT_FALSE(reaches(after));
}

}  // namespace
}  // namespace tsar
