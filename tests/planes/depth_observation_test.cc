// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/planes/depth_observation.h"

#include "tests/support/synthetic_observations.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

class DepthObservationTest : public testing::Test {
 protected:
  const WorldPlane plane_ = PlaneThrough({0.4, -0.2, -1.0}, {0.0, 0.0, 4.0});
  const WorldPlane opposite_ = {-plane_.normal, -plane_.offset};
  // Of a plane 4 units before the camera, which lies in z = 0.
  const WorldPlane flat_ = PlaneThrough({0.0, 0.0, 1.0}, {0.0, 0.0, 4.0});
};

TEST_F(DepthObservationTest, ResidualIsTheDifferenceOfDepthsInExpectedErrors) {
  for (DepthObservation observation : ObservePlane(plane_, 4)) {
    const double depth = observation.depth;
    EXPECT_NEAR(NormalizedResidual(plane_, observation), 0.0, 1e-9);
    observation.depth = 1.1 * depth;
    const double expected = 0.1 * depth / observation.sigma;
    EXPECT_NEAR(std::abs(NormalizedResidual(plane_, observation)),
                expected,
                1e-9 * expected);
    EXPECT_EQ(NormalizedResidual(opposite_, observation),
              -NormalizedResidual(plane_, observation));
  }
}

TEST_F(DepthObservationTest, FootPointIsThatOfTheRightDepth) {
  for (DepthObservation observation : ObservePlane(plane_, 4)) {
    const Eigen::Vector3d point = observation.Point();
    observation.depth *= 1.3;
    EXPECT_LT((FootPoint(plane_, observation) - point).norm(), 1e-12);
    EXPECT_LT((FootPoint(opposite_, observation) - point).norm(), 1e-12);
  }
}

TEST_F(DepthObservationTest, SlopeIsBoundedForGrazingRays) {
  DepthObservation observation;
  observation.ray = {3.0, 4.0, 1.0};
  EXPECT_DOUBLE_EQ(RaySlope(flat_, observation), 1.0);
  // 0.05 of a ray of length 5.
  for (const double z : {0.2, 0.0, -0.2}) {
    observation.ray = {3.0, std::sqrt(16.0 - z * z), z};
    EXPECT_DOUBLE_EQ(RaySlope(flat_, observation), 0.25);
    observation.depth = 2.0;
    observation.sigma = 0.5;
    EXPECT_NEAR(NormalizedResidual(flat_, observation),
                (2.0 * z - 4.0) / (0.25 * 0.5),
                1e-12);
  }
}

}  // namespace
}  // namespace tsar
