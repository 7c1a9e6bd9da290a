// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/planes/fit_plane.h"

#include <cmath>
#include <limits>

#include "tests/support/synthetic_observations.h"
#include "tests/view/planes/fit_plane_checks.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

WorldPlane FitFrom(const WorldPlane& initial,
                   const std::vector<DepthObservation>& observations) {
  return FitPlane(initial, ToSamples(observations), kLossScale);
}

class FitPlaneTest : public testing::Test {
 protected:
  WorldPlane Fit(const std::vector<DepthObservation>& observations) const {
    return FitFrom(initial_, observations);
  }

  const Eigen::Vector3d middle_{0.0, 0.0, 4.0};
  const WorldPlane plane_ = PlaneThrough({0.4, -0.2, -1.0}, middle_);
  // A depth of 4 is expected to err by 0.03.
  const WorldPlane initial_ = Displaced(plane_, middle_, 3.0, 0.08);
  const std::vector<DepthObservation> clean_ = ObservePlane(plane_, 12);
};

TEST_F(FitPlaneTest, AveragesTheErrorsOfAllViews) {
  Philox random(1, 0, 0);
  const WorldPlane fitted = Fit(AddNoise(clean_, &random));
  // 432 depths, each with an error of 0.03 or more.
  EXPECT_NEAR(fitted.Height(middle_), 0.0, 0.006);
  EXPECT_LT(AngleBetween(fitted, plane_), 0.3);
}

TEST_F(FitPlaneTest, DoesNotDependOnTheInitialPlane) {
  Philox random(7, 0, 0);
  const std::vector<DepthObservation> noisy = AddNoise(clean_, &random);
  const WorldPlane fitted = Fit(noisy);
  const WorldPlane other =
      FitFrom(Displaced(plane_, middle_, -2.0, -0.06), noisy);
  // A thousandth of the standard error is 1e-6.
  EXPECT_NEAR(other.Height(middle_), fitted.Height(middle_), 1e-7);
  EXPECT_LT((other.normal - fitted.normal).norm(), 1e-7);
}

TEST_F(FitPlaneTest, IsAtTheMinimumOfTheLoss) {
  // With errors so large that the slopes of the rays matter.
  std::vector<DepthObservation> observations = clean_;
  for (DepthObservation& observation : observations) {
    observation.sigma = 0.1 * observation.depth;
  }
  Philox random(6, 0, 0);
  observations = AddNoise(observations, &random);
  const WorldPlane fitted = Fit(observations);
  const auto loss = [&](double degrees, double other_degrees, double height) {
    // Turned about two axes along the plane, then moved.
    const Eigen::Vector3d axis = fitted.normal.unitOrthogonal();
    const Eigen::Vector3d turned =
        Eigen::AngleAxisd(degrees * M_PI / 180.0, axis) *
        Eigen::AngleAxisd(other_degrees * M_PI / 180.0,
                          fitted.normal.cross(axis)) *
        fitted.normal;
    const WorldPlane plane = PlaneThrough(
        turned, middle_ + (height - fitted.Height(middle_)) * fitted.normal);
    double sum = 0.0;
    for (const DepthObservation& observation : observations) {
      const double residual =
          NormalizedResidual(plane, observation) / kLossScale;
      sum += std::log1p(residual * residual);
    }
    return sum;
  };
  // By how many steps the minimum of the parabola through three losses misses
  // the plane.
  const auto missed_by = [&](double degrees, double other, double height) {
    const double before = loss(-degrees, -other, -height);
    const double after = loss(degrees, other, height);
    const double curvature = before + after - 2.0 * loss(0.0, 0.0, 0.0);
    EXPECT_GT(curvature, 0.0);
    return 0.5 * (before - after) / curvature;
  };
  EXPECT_NEAR(missed_by(0.05, 0.0, 0.0), 0.0, 0.1);
  EXPECT_NEAR(missed_by(0.0, 0.05, 0.0), 0.0, 0.1);
  EXPECT_NEAR(missed_by(0.0, 0.0, 0.002), 0.0, 0.1);
}

TEST_F(FitPlaneTest, IsNotDrawnByAThirdOfOutliers) {
  Philox random(2, 0, 0);
  std::vector<DepthObservation> observations = clean_;
  const WorldPlane behind = Displaced(plane_, middle_, 0.0, -0.6);
  int num_outliers = 0;
  for (DepthObservation& observation : observations) {
    const uint32_t kind = random.NextBelow(20);
    if (kind < 4) {
      observation.depth = -behind.Height(observation.center) /
                          behind.normal.dot(observation.ray);
    } else if (kind < 6) {
      observation.depth *= 1e6;
    }
    num_outliers += kind < 6;
  }
  ASSERT_GT(num_outliers, 110);
  const WorldPlane fitted = Fit(observations);
  EXPECT_NEAR(fitted.Height(middle_), 0.0, 0.001);
  EXPECT_LT(AngleBetween(fitted, plane_), 0.1);
}

TEST_F(FitPlaneTest, FollowsTheWeights) {
  const WorldPlane other = Displaced(plane_, middle_, 0.0, 0.004);
  std::vector<DepthObservation> observations = ObservePlane(other, 12);
  for (DepthObservation& observation : observations) {
    observation.weight = 0.0;
  }
  observations.insert(observations.end(), clean_.begin(), clean_.end());
  ExpectSame(Fit(observations), Fit(clean_));
  for (DepthObservation& observation : observations) {
    observation.weight = observation.weight == 0.0 ? 3.0 : 1.0;
  }
  EXPECT_NEAR(Fit(observations).Height(middle_), -0.003, 0.0002);
}

TEST_F(FitPlaneTest, DoesNotDependOnTheScale) {
  Philox random(3, 0, 0);
  const std::vector<DepthObservation> observations = AddNoise(clean_, &random);
  const WorldPlane fitted = Fit(observations);
  for (const double scale : {1000.0, 0.001}) {
    const WorldPlane scaled =
        FitFrom({initial_.normal, scale * initial_.offset},
                Scaled(observations, scale));
    EXPECT_LT((scaled.normal - fitted.normal).norm(), 1e-9);
    EXPECT_NEAR(scaled.offset / (scale * fitted.offset), 1.0, 1e-9);
  }
}

TEST_F(FitPlaneTest, BearsGrazingViews) {
  // One view along the plane, from just above it, besides those that see it.
  const Eigen::Vector3d along = plane_.normal.unitOrthogonal();
  const Camera grazing =
      CameraLookingAt(middle_ - 3.0 * along + 0.03 * plane_.normal, middle_);
  std::vector<DepthObservation> observations = clean_;
  for (int i = 0; i < 200; ++i) {
    DepthObservation observation =
        ObservePlane(plane_, grazing, {-0.2 + 0.002 * i, 0.0, 1.0});
    // Any depth lies near the plane, and half of the rays point away from it.
    observation.ray += (i % 2 == 0 ? 1e-3 : -0.02) * plane_.normal;
    observation.depth = 2.0 + 0.01 * i;
    observation.sigma = 0.01;
    observations.push_back(observation);
  }
  const WorldPlane fitted = FitFrom(Fit(observations), observations);
  EXPECT_LT(AngleBetween(fitted, plane_), 0.1);
  EXPECT_NEAR(fitted.Height(middle_), 0.0, 0.002);
}

TEST_F(FitPlaneTest, NeedsThreeObservations) {
  std::vector<DepthObservation> few = {clean_[0], clean_[70]};
  ExpectSame(Fit({}), initial_);
  ExpectSame(Fit({clean_[0]}), initial_);
  ExpectSame(Fit(few), initial_);
  few.push_back(clean_[138]);
  EXPECT_LT(AngleBetween(Fit(few), plane_), 1e-3);
  few.back().weight = 0.0;
  ExpectSame(Fit(few), initial_);
}

TEST_F(FitPlaneTest, ReturnsTheInitialPlaneOfObservationsOnALine) {
  Philox random(5, 0, 0);
  const Eigen::Vector3d direction = plane_.normal.unitOrthogonal();
  std::vector<DepthObservation> line;
  for (int i = 0; i < 40; ++i) {
    DepthObservation observation;
    observation.ray = middle_ + (0.05 * i - 1.0) * direction;
    observation.depth = 1.0;
    observation.sigma = 0.01;
    line.push_back(observation);
  }
  // One view, without and with errors along its rays.
  ExpectSame(Fit(line), initial_);
  ExpectSame(Fit(AddNoise(line, &random)), initial_);
  // Views from two sides, whose rays meet the initial plane in two lines.
  std::vector<DepthObservation> both = line;
  const Eigen::Vector3d other_center(1.0, 2.0, -1.0);
  for (DepthObservation observation : line) {
    observation.ray = observation.Point() - other_center;
    observation.center = other_center;
    both.push_back(observation);
  }
  ExpectSame(Fit(both), initial_);
  // From a side where they seem to determine a plane until one goes through
  // the line.
  const Eigen::Vector3d beside = 2.0 * plane_.normal.cross(direction);
  both = line;
  for (DepthObservation observation : line) {
    observation.ray = observation.Point() - beside;
    observation.center = beside;
    both.push_back(observation);
  }
  const WorldPlane behind = Displaced(plane_, middle_, 0.0, 0.2);
  ExpectSame(FitFrom(behind, both), behind);
  // All depths of one ray.
  ExpectSame(Fit(std::vector<DepthObservation>(20, line[0])), initial_);
}

TEST_F(FitPlaneTest, ReturnsTheInitialPlaneOfDepthsThatAreNoNumbers) {
  for (const double depth : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    std::vector<DepthObservation> observations = clean_;
    observations[17].depth = depth;
    ExpectSame(Fit(observations), initial_);
  }
  // One whose loss overflows.
  std::vector<DepthObservation> observations = clean_;
  observations[17].sigma = 1e-200;
  ExpectSame(Fit(observations), initial_);
}

TEST(FitSamplesTest, MiddleIsOfTheMediansOfTheCoordinates) {
  FitSamples samples;
  EXPECT_EQ(samples.Middle(), Eigen::Vector3d::Zero());
  for (int i = 1; i <= 11; ++i) {
    DepthObservation observation;
    observation.center = {1.0, 2.0, 0.0};
    observation.ray = {0.0, 1.0, 1.0};
    observation.depth = i < 8 ? i : 1e6 * i;
    observation.weight = i;  // Has no effect.
    samples.Add(observation);
  }
  EXPECT_EQ(samples.Middle(), Eigen::Vector3d(1.0, 8.0, 6.0));
}

}  // namespace
}  // namespace tsar
