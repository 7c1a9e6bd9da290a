// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/adjustment/adjust_planes.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tsar {
namespace {

using Kind = PlaneAnglePrior::Kind;

// Its normal lies in the x-z plane, so many degrees from x.
ModelPlane PlaneAt(double degrees, int component = 0) {
  ModelPlane plane;
  const double angle = degrees * M_PI / 180.0;
  plane.plane.normal = {std::cos(angle), 0.0, std::sin(angle)};
  plane.component = component;
  return plane;
}

TEST(FindAnglePriorsTest, NearlyParallelAndOrthogonalPlanesAreTied) {
  const std::vector<PlaneAnglePrior> priors =
      FindAnglePriors({PlaneAt(0.0), PlaneAt(92.5), PlaneAt(182.0)});
  ASSERT_EQ(priors.size(), 3u);
  EXPECT_EQ(priors[0].kind, Kind::kOrthogonal);
  EXPECT_EQ(priors[0].first, 0);
  EXPECT_EQ(priors[0].second, 1);
  EXPECT_EQ(priors[1].kind, Kind::kParallel);
  EXPECT_EQ(priors[1].first, 0);
  EXPECT_EQ(priors[1].second, 2);
  EXPECT_EQ(priors[2].kind, Kind::kOrthogonal);
  EXPECT_NEAR(priors[0].sigma * 180.0 / M_PI, 0.5, 1e-3);
}

TEST(FindAnglePriorsTest, OtherAnglesAndOtherComponentsAreNot) {
  EXPECT_TRUE(FindAnglePriors({PlaneAt(0.0), PlaneAt(4.0)}).empty());
  EXPECT_TRUE(FindAnglePriors({PlaneAt(0.0), PlaneAt(85.0)}).empty());
  EXPECT_TRUE(FindAnglePriors({PlaneAt(0.0), PlaneAt(1.0, 1)}).empty());
  EXPECT_TRUE(FindAnglePriors({}).empty());
}

TEST(FindAnglePriorsTest, PlanesInAFrameNeedNone) {
  std::vector<ModelPlane> planes = {PlaneAt(0.0), PlaneAt(90.0), PlaneAt(1.0)};
  planes[0].axis = planes[1].axis = 0;
  const std::vector<PlaneAnglePrior> priors = FindAnglePriors(planes);
  ASSERT_EQ(priors.size(), 2u);
  EXPECT_EQ(priors[0].second, 2);
  EXPECT_EQ(priors[1].second, 2);
}

TEST(FindAnglePriorsTest, TheirNumberGrowsWithThatOfThePlanes) {
  const std::vector<ModelPlane> planes(100, PlaneAt(0.0));
  EXPECT_LT(FindAnglePriors(planes).size(), 3 * planes.size());
}

}  // namespace
}  // namespace tsar
