// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/planes/fit_plane.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cmath>
#include <limits>

#include "tests/support/synthetic_observations.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

const double kInfinity = std::numeric_limits<double>::infinity();

// Where the plane z = 2 is seen from above: depth and height are the same.
DepthObservation Above(double x, double y, double sigma) {
  DepthObservation observation;
  observation.center = {x, y, 0.0};
  observation.depth = 2.0;
  observation.sigma = sigma;
  return observation;
}

class PlaneUncertaintyTest : public testing::Test {
 protected:
  // The spread of the heights of repeated fits, at a point of the plane, over
  // the predicted spread. Each fit is repeated from where it ended, since it
  // goes just a few steps.
  double MeasuredOverPredicted(const Eigen::Vector3d& point,
                               double loss_scale) const {
    const int num_fits = 400;
    Philox random(5, 0, 0);
    double squares = 0.0;
    for (int i = 0; i < num_fits; ++i) {
      FitSamples samples;
      for (const DepthObservation& observation :
           AddNoise(observations_, &random)) {
        samples.Add(observation);
      }
      WorldPlane fit = plane_;
      for (int j = 0; j < 5; ++j) {
        fit = FitPlane(fit, samples, loss_scale);
      }
      squares += std::pow(fit.Height(point), 2);
    }
    return std::sqrt(squares / num_fits) /
           ComputeUncertainty(plane_, observations_).Sigma(point);
  }

  Eigen::Vector3d OnPlane(double x, double y) const {
    const Eigen::Vector3d point(x, y, 4.0);
    return point - plane_.Height(point) * plane_.normal;
  }

  const WorldPlane plane_ = PlaneThrough({0.4, -0.2, -1.0}, {0.0, 0.0, 4.0});
  const WorldPlane flat_ = PlaneThrough({0.0, 0.0, 1.0}, {0.0, 0.0, 2.0});
  const std::vector<DepthObservation> observations_ = ObservePlane(plane_, 8);
};

TEST_F(PlaneUncertaintyTest, OfFourCornersIsThatOfTheirRegression) {
  const PlaneUncertainty uncertainty =
      ComputeUncertainty(flat_,
                         {Above(-1.0, -1.0, 0.1),
                          Above(-1.0, 1.0, 0.1),
                          Above(1.0, -1.0, 0.1),
                          Above(1.0, 1.0, 0.1)});
  EXPECT_NEAR(uncertainty.Sigma({0.0, 0.0, 2.0}), 0.05, 1e-12);
  EXPECT_NEAR(uncertainty.Sigma({2.0, 0.0, 2.0}), 0.05 * std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(uncertainty.Sigma({2.0, -2.0, 2.0}), 0.15, 1e-12);
}

TEST_F(PlaneUncertaintyTest, IsTheSpreadOfRepeatedFits) {
  const double least_squares = 1000.0;
  EXPECT_NEAR(MeasuredOverPredicted(OnPlane(0.0, 0.0), least_squares), 1, 0.2);
  EXPECT_NEAR(MeasuredOverPredicted(OnPlane(1.5, 1.0), least_squares), 1, 0.2);
  EXPECT_NEAR(MeasuredOverPredicted(OnPlane(-9.0, 4.), least_squares), 1, 0.2);
  EXPECT_NEAR(MeasuredOverPredicted(OnPlane(1.0, -8.), least_squares), 1, 0.2);
}

TEST_F(PlaneUncertaintyTest, IsExceededByFitsWithARobustLossAsDocumented) {
  const double loss_scale = 0.5;
  EXPECT_NEAR(MeasuredOverPredicted(OnPlane(0., 0.), loss_scale), 1.37, 0.15);
  EXPECT_NEAR(MeasuredOverPredicted(OnPlane(-9., 4.), loss_scale), 1.37, 0.15);
}

TEST_F(PlaneUncertaintyTest, IsInfiniteWhereNothingIsDetermined) {
  EXPECT_EQ(ComputeUncertainty(flat_, {}).Sigma({0.0, 0.0, 2.0}), kInfinity);
  const PlaneUncertainty of_one = ComputeUncertainty(flat_, {Above(1, 2, 0.1)});
  EXPECT_NEAR(of_one.Sigma({1.0, 2.0, 2.0}), 0.1, 1e-12);
  EXPECT_EQ(of_one.Sigma({1.1, 2.0, 2.0}), kInfinity);
  const PlaneUncertainty of_two =
      ComputeUncertainty(flat_, {Above(1, 2, 0.1), Above(3, 4, 0.1)});
  EXPECT_NEAR(of_two.Sigma({3.0, 4.0, 2.0}), 0.1, 1e-12);
  EXPECT_NEAR(of_two.Sigma({2.0, 3.0, 2.0}), 0.1 / std::sqrt(2.0), 1e-12);
  EXPECT_EQ(of_two.Sigma({2.0, 3.1, 2.0}), kInfinity);
}

class DepthObservationTest : public testing::Test {
 protected:
  const WorldPlane plane_ = PlaneThrough({0.4, -0.2, -1.0}, {0.0, 0.0, 4.0});
  const WorldPlane opposite_ = {-plane_.normal, -plane_.offset};
  // A plane 4 units in front of the camera, which lies in z = 0.
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

class WorldPlaneTest : public testing::Test {
 protected:
  const Camera camera_ = CameraLookingAt({1.0, -2.0, 0.5}, {0.5, 0.3, 4.0});
  const WorldPlane plane_ = PlaneThrough({0.3, -0.2, -1.0}, {0.0, 0.0, 4.0});
};

TEST_F(WorldPlaneTest, FacesTheCameraWhateverItsDirection) {
  const WorldPlane opposite = {-plane_.normal, -plane_.offset};
  const Plane plane = ToCameraPlane(plane_, camera_);
  EXPECT_TRUE(plane.Valid());
  EXPECT_EQ(ToCameraPlane(opposite, camera_).normal, plane.normal);
  EXPECT_EQ(ToCameraPlane(opposite, camera_).offset, plane.offset);
  EXPECT_NEAR(plane.offset, std::abs(plane_.Height(camera_.Center())), 1e-6);
}

TEST_F(WorldPlaneTest, HasTheSameDepthsInBothFrames) {
  const Plane plane = ToCameraPlane(plane_, camera_);
  for (const Eigen::Vector3d& ray : {Eigen::Vector3d(0.0, 0.0, 1.0),
                                     Eigen::Vector3d(0.5, -0.3, 1.0),
                                     Eigen::Vector3d(-0.4, 0.6, 1.0)}) {
    const double depth = ObservePlane(plane_, camera_, ray).depth;
    ASSERT_GT(depth, 1.0);
    EXPECT_NEAR(
        plane.Depth(
            {static_cast<float>(ray.x()), static_cast<float>(ray.y()), 1.f}),
        depth,
        2e-6 * depth);
  }
}

TEST_F(WorldPlaneTest, KeepsItsPlaceFarFromTheOrigin) {
  const Eigen::Vector3d far(4e6, -5e5, 300.0);
  const Camera camera = CameraLookingAt(camera_.Center() + far,
                                        Eigen::Vector3d(0.5, 0.3, 4.0) + far);
  const WorldPlane plane =
      PlaneThrough(plane_.normal, far + Eigen::Vector3d(0.0, 0.0, 4.0));
  const Plane near_plane = ToCameraPlane(plane_, camera_);
  EXPECT_NEAR(ToCameraPlane(plane, camera).offset, near_plane.offset, 1e-6);
  const WorldPlane back = ToWorldPlane(ToCameraPlane(plane, camera), camera);
  EXPECT_NEAR(back.Height(camera.Center()), near_plane.offset, 1e-6);
}

}  // namespace
}  // namespace tsar
