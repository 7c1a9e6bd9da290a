// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/adjustment/adjust_planes.h"

#include <cmath>
#include <vector>

#include "tests/scene/adjustment/adjust_planes_fixture.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

using Eigen::Vector3d;

// A corner of a room that stands askew: the wall's normal points to the
// cameras, the floor's upwards.
const Eigen::Matrix3d kRoom =
    Eigen::AngleAxisd(0.7, Vector3d(1.0, -2.0, 0.5).normalized())
        .toRotationMatrix();
Vector3d At(double right, double up, double ahead) {
  return kRoom * Vector3d(right, up, ahead);
}
const Patch kWall = {At(0.0, 0.0, 5.0), At(2.0, 0.0, 0.0), At(0.0, 1.0, 0.0)};
const Patch kFloor = {At(0.0, -1.5, 3.0), At(0.0, 0.0, 1.5), At(2.0, 0.0, 0.0)};
const std::vector<Vector3d> kCenters = {At(0.1, 0.2, -0.3),
                                        At(-0.8, 0.1, 0.0),
                                        At(0.9, 0.3, 0.1),
                                        At(-0.3, -0.4, 0.4),
                                        At(0.4, 0.6, -0.2)};

// Of each measurement of a plane by all views.
Observations ObserveByAll(int plane, const Patch& patch, const Bias& bias) {
  Observations observations;
  for (const Vector3d& center : kCenters) {
    observations.emplace_back(plane, ObservePatch(patch, center, 10, bias));
  }
  return observations;
}

void Append(const Observations& more, Observations* observations) {
  observations->insert(observations->end(), more.begin(), more.end());
}

// Two bands of the wall, of which the upper one seems nearer, and the floor.
class LeaningWallTest : public testing::Test {
 protected:
  LeaningWallTest() {
    adjustment_.planes = {kWall.Plane(), kFloor.Plane()};
    for (const double side : {-1.0, 1.0}) {
      const Patch band = {
          At(0.0, 0.3 * side, 5.0), At(2.0, 0.0, 0.0), At(0.0, 0.05, 0.0)};
      Append(ObserveByAll(0, band, {.shift = side}), &observations_);
    }
    Append(ObserveByAll(1, kFloor, {}), &observations_);
  }

  double LeanOfWall(const AdjustedPlanes& adjusted) {
    return AngleBetween(adjusted.planes[0].plane, kWall.Plane());
  }

  PlaneAdjustment adjustment_;
  Observations observations_;
};

TEST_F(LeaningWallTest, LeansAlone) {
  const AdjustedPlanes adjusted =
      AdjustPlanes(adjustment_, Measure(observations_));
  EXPECT_GT(LeanOfWall(adjusted), 3.0);
  EXPECT_LT(AngleBetween(adjusted.planes[1].plane, kFloor.Plane()), 0.01);
}

TEST_F(LeaningWallTest, StandsUprightInAFrame) {
  adjustment_.frames = {
      Eigen::AngleAxisd(0.02, Vector3d::UnitX()).toRotationMatrix() * kRoom};
  adjustment_.axes = {{0, 2}, {0, 1}};
  const AdjustedPlanes adjusted =
      AdjustPlanes(adjustment_, Measure(observations_));
  EXPECT_LT(LeanOfWall(adjusted), 0.6);
  // Exactly along the frame.
  const Vector3d wall = adjusted.planes[0].plane.normal;
  EXPECT_TRUE(wall == adjusted.frames[0].col(2) ||
              wall == -adjusted.frames[0].col(2));
  EXPECT_NEAR(wall.dot(adjusted.planes[1].plane.normal), 0.0, 1e-14);
  // The floor tells about the turn that would let the wall lean.
  EXPECT_LT(adjusted.planes[0].covariance.trace(), 1e-2);
}

TEST_F(LeaningWallTest, FrameKeepsTheSideOfNormals) {
  adjustment_.frames = {kRoom};
  adjustment_.axes = {{0, 2}, {0, 1}};
  for (const double sign : {-1.0, 1.0}) {
    adjustment_.planes[0] = {sign * kRoom.col(2),
                             -sign * kRoom.col(2).dot(kWall.middle)};
    const AdjustedPlanes adjusted =
        AdjustPlanes(adjustment_, Measure(observations_));
    EXPECT_GT(adjusted.planes[0].plane.normal.dot(adjustment_.planes[0].normal),
              0.9);
  }
}

TEST(AdjustPlanes, StrongEvidenceOverrulesASoftPrior) {
  // By 25 expected errors of the prior, it does lean.
  Patch wall = kWall;
  wall.half_width = At(0.0, std::cos(Radians(5.0)), std::sin(Radians(5.0)));
  Observations observations = ObserveByAll(0, wall, {});
  Append(ObserveByAll(1, kFloor, {}), &observations);
  PlaneAdjustment adjustment;
  adjustment.planes = {wall.Plane(), kFloor.Plane()};
  adjustment.angles = {
      {PlaneAnglePrior::Kind::kOrthogonal, 0, 1, Radians(0.2)}};
  const AdjustedPlanes adjusted =
      AdjustPlanes(adjustment, Measure(observations));
  EXPECT_LT(AngleBetween(adjusted.planes[0].plane, wall.Plane()), 0.3);
  EXPECT_LT(AngleBetween(adjusted.planes[1].plane, kFloor.Plane()), 0.3);
}

TEST_F(LeaningWallTest, SoftPriorDecidesWhereEvidenceIsWeak) {
  for (auto& [plane, of_view] : observations_) {
    for (DepthObservation& observation : of_view) {
      observation.sigma *= plane == 0 ? 20.0 : 1.0;
    }
  }
  const double alone =
      LeanOfWall(AdjustPlanes(adjustment_, Measure(observations_)));
  EXPECT_GT(alone, 3.0);
  adjustment_.angles = {{PlaneAnglePrior::Kind::kOrthogonal, 0, 1, 0.01}};
  EXPECT_LT(LeanOfWall(AdjustPlanes(adjustment_, Measure(observations_))),
            0.2 * alone);
  // A wall at the back, whose normal points the other way.
  const Patch back = {
      At(0.0, 0.0, -5.0), At(2.0, 0.0, 0.0), At(0.0, -1.0, 0.0)};
  adjustment_.planes.push_back(back.Plane());
  Append(ObserveByAll(2, back, {}), &observations_);
  adjustment_.angles = {{PlaneAnglePrior::Kind::kParallel, 0, 2, 0.01}};
  EXPECT_LT(LeanOfWall(AdjustPlanes(adjustment_, Measure(observations_))),
            0.2 * alone);
}

TEST(AdjustPlanes, OneBiasedViewOfFive) {
  Philox random(1, 2, 3);
  Observations observations;
  for (size_t v = 0; v < kCenters.size(); ++v) {
    observations.emplace_back(
        0,
        ObservePatch(
            kWall, kCenters[v], 12, {.shift = v == 1 ? 8.0 : 0.0}, &random));
  }
  PlaneAdjustment adjustment;
  adjustment.planes = {Displaced(kWall.Plane(), kWall.middle, 0.5, 0.05)};
  const AdjustedPlanes adjusted =
      AdjustPlanes(adjustment, Measure(observations));
  EXPECT_LT(SquaredError(adjusted.planes[0], kWall.Plane()), 6.0);
  // Some 8 mm: that of the mean would be 80.
  EXPECT_LT(std::abs(ErrorOf(adjusted.planes[0], kWall.Plane())[2]), 0.02);
}

// By noise alone, and where each view errs as a whole.
TEST(AdjustPlanes, CovarianceTellsTheErrors) {
  for (const double common : {0.0, 0.5}) {
    MeasurePlaneOptions options;
    options.common_deviation = common;
    double squares = 0.0;
    Vector3d each = Vector3d::Zero();
    constexpr int kDraws = 200;
    for (int draw = 0; draw < kDraws; ++draw) {
      Philox random(draw, 7, 3);
      Observations observations;
      for (const Vector3d& center : kCenters) {
        // u and v have a deviation of 0.63 over the patch.
        const double shift = common * NextNormal(&random);
        const double lean_u = common * NextNormal(&random) / 0.63;
        const double lean_v = common * NextNormal(&random) / 0.63;
        observations.emplace_back(
            0,
            ObservePatch(kWall, center, 10, {shift, lean_u, lean_v}, &random));
      }
      PlaneAdjustment adjustment;
      adjustment.planes = {Displaced(kWall.Plane(), kWall.middle, 0.3, 0.02)};
      const ModelPlane plane =
          AdjustPlanes(adjustment, Measure(observations, options)).planes[0];
      squares += SquaredError(plane, kWall.Plane());
      const Vector3d error = ErrorOf(plane, kWall.Plane());
      each += error.cwiseAbs2().cwiseQuotient(plane.covariance.diagonal());
    }
    EXPECT_GT(std::sqrt(squares / (3 * kDraws)), 0.7) << common;
    EXPECT_LT(std::sqrt(squares / (3 * kDraws)), 1.4) << common;
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(std::sqrt(each[i] / kDraws), 0.7) << common << " " << i;
      EXPECT_LT(std::sqrt(each[i] / kDraws), 1.4) << common << " " << i;
    }
  }
}

TEST(AdjustPlanes, CovarianceOfPlanesInAFrameTellsTheErrors) {
  double squares = 0.0;
  constexpr int kDraws = 200;
  for (int draw = 0; draw < kDraws; ++draw) {
    Philox random(draw, 8, 3);
    Observations observations;
    for (const Vector3d& center : kCenters) {
      observations.emplace_back(0, ObservePatch(kWall, center, 6, {}, &random));
      observations.emplace_back(1,
                                ObservePatch(kFloor, center, 6, {}, &random));
    }
    PlaneAdjustment adjustment;
    adjustment.planes = {kWall.Plane(), kFloor.Plane()};
    adjustment.frames = {kRoom};
    adjustment.axes = {{0, 2}, {0, 1}};
    MeasurePlaneOptions options;
    options.common_deviation = 0.0;
    const AdjustedPlanes adjusted =
        AdjustPlanes(adjustment, Measure(observations, options));
    squares += SquaredError(adjusted.planes[0], kWall.Plane()) +
               SquaredError(adjusted.planes[1], kFloor.Plane());
  }
  EXPECT_GT(std::sqrt(squares / (6 * kDraws)), 0.7);
  EXPECT_LT(std::sqrt(squares / (6 * kDraws)), 1.4);
}

}  // namespace
}  // namespace tsar
