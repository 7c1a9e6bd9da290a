// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/adjustment/adjust_planes.h"

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

#include "tests/scene/adjustment/adjust_planes_fixture.h"
#include <Eigen/LU>
#include <gtest/gtest.h>

namespace tsar {
namespace {

using Eigen::Vector3d;

const Patch kWall = {{0.0, 0.0, 5.0}, {2.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
const Patch kFloor = {{0.0, -1.5, 3.0}, {0.0, 0.0, 1.5}, {2.0, 0.0, 0.0}};
const Vector3d kCenter(0.1, 0.2, -0.3);

void ExpectSame(const WorldPlane& a, const WorldPlane& b) {
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.offset, b.offset);
}

bool IsUnknown(const Eigen::Matrix3d& covariance) {
  Eigen::Matrix3d finite = covariance;
  finite.diagonal().setZero();
  return finite.isZero(0.0) && covariance.diagonal().array().isInf().all();
}

TEST(AdjustPlanesUnknown, Nothing) {
  const AdjustedPlanes adjusted = AdjustPlanes({}, MeasureNothing);
  EXPECT_TRUE(adjusted.planes.empty());
  EXPECT_TRUE(adjusted.frames.empty());
}

TEST(AdjustPlanesUnknown, UnmeasuredPlanesStay) {
  PlaneAdjustment adjustment;
  adjustment.planes = {kFloor.Plane(), Displaced(kWall.Plane(), kCenter, 9, 3)};
  adjustment.frames = {Eigen::Matrix3d::Identity()};
  // One of them beside one that is measured.
  for (const bool measured : {false, true}) {
    Observations observations;
    if (measured) {
      observations.emplace_back(0, ObservePatch(kFloor, kCenter, 8));
    }
    const AdjustedPlanes adjusted =
        AdjustPlanes(adjustment, Measure(observations));
    ExpectSame(adjusted.planes[1].plane, adjustment.planes[1]);
    EXPECT_TRUE(IsUnknown(adjusted.planes[1].covariance));
    EXPECT_EQ(IsUnknown(adjusted.planes[0].covariance), !measured);
    EXPECT_EQ(adjusted.frames[0], adjustment.frames[0]);
  }
}

TEST(AdjustPlanesUnknown, TwoUnmeasuredPlanesStayWhateverTheirAngle) {
  PlaneAdjustment adjustment;
  adjustment.planes = {kWall.Plane(),
                       Displaced(kFloor.Plane(), kFloor.middle, 3.0, 0.1)};
  adjustment.angles = {{PlaneAnglePrior::Kind::kOrthogonal, 0, 1, 0.01}};
  const AdjustedPlanes adjusted = AdjustPlanes(adjustment, MeasureNothing);
  for (int p = 0; p < 2; ++p) {
    ExpectSame(adjusted.planes[p].plane, adjustment.planes[p]);
    EXPECT_TRUE(IsUnknown(adjusted.planes[p].covariance));
  }
}

TEST(AdjustPlanesUnknown, PlaneMeasuredOnALineTurnsNotAboutIt) {
  const Patch line = {kWall.middle, {2.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  const Observations observations = {{0, ObservePatch(line, kCenter, 10)},
                                     {0, ObservePatch(line, {1, 1, 0}, 10)}};
  // Turned about the line by 2 degrees, and moved.
  const Vector3d normal =
      Eigen::AngleAxisd(Radians(2.0), Vector3d::UnitX()) * Vector3d::UnitZ();
  PlaneAdjustment adjustment;
  adjustment.planes = {
      PlaneThrough(normal, kWall.middle + Vector3d(0.0, 0.0, 0.1))};
  const ModelPlane plane =
      AdjustPlanes(adjustment, Measure(observations)).planes[0];
  EXPECT_LT(plane.plane.normal.cross(normal).norm(), 1e-3);
  EXPECT_NEAR(plane.plane.Height(kWall.middle), 0.0, 1e-3);
  EXPECT_LT(plane.axis_t.cross(Vector3d::UnitX()).norm(), 1e-4);
  EXPECT_LT(plane.covariance(0, 0), 1e-3);
  EXPECT_TRUE(std::isinf(plane.covariance(1, 1)));
  EXPECT_LT(plane.covariance(2, 2), 1e-3);
  EXPECT_EQ(plane.covariance(0, 1), 0.0);
}

TEST(AdjustPlanesUnknown, PlaneThroughTheCameraThatMeasuredItStays) {
  PlaneAdjustment adjustment;
  adjustment.planes = {PlaneThrough(Vector3d::UnitY(), kCenter)};
  const Observations observations = {{0, ObservePatch(kWall, kCenter, 10)}};
  const MeasurePlanes elsewhere = [&](const std::vector<WorldPlane>&) {
    return Measure(observations)({kWall.Plane()});
  };
  for (const MeasurePlanes& measure : {Measure(observations), elsewhere}) {
    const AdjustedPlanes adjusted = AdjustPlanes(adjustment, measure);
    ExpectSame(adjusted.planes[0].plane, adjustment.planes[0]);
    EXPECT_TRUE(IsUnknown(adjusted.planes[0].covariance));
  }
}

// A wall that is free, and a floor and another wall in a frame.
struct Corner {
  explicit Corner(double scale = 1.0,
                  const Vector3d& origin = Vector3d::Zero(),
                  bool has_noise = true) {
    Philox random(5, 6, 7);
    const Patch side = {{3.0, 0.0, 2.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    const Patch patches[] = {kWall, kFloor, side};
    for (int p = 0; p < 3; ++p) {
      for (const Vector3d& center : {Vector3d(0, 0, 0), Vector3d(1, 1, 0)}) {
        observations.emplace_back(
            p,
            ObservePatch(
                patches[p], center, 8, {}, has_noise ? &random : nullptr));
      }
      const WorldPlane plane =
          Displaced(patches[p].Plane(), patches[p].middle, 1.0, 0.1);
      adjustment.planes.push_back(
          {plane.normal, scale * plane.offset - plane.normal.dot(origin)});
    }
    for (auto& [plane, of_view] : observations) {
      for (DepthObservation& observation : of_view) {
        observation.center = scale * observation.center + origin;
        observation.depth *= scale;
        observation.sigma *= scale;
      }
    }
    adjustment.frames = {
        Eigen::AngleAxisd(0.01, Vector3d::UnitX()).toRotationMatrix()};
    adjustment.axes = {{-1, -1}, {0, 1}, {0, 0}};
    adjustment.angles = {{PlaneAnglePrior::Kind::kOrthogonal, 0, 1, 0.01},
                         {PlaneAnglePrior::Kind::kOrthogonal, 1, 2, 0.01}};
  }

  AdjustedPlanes Adjust() const {
    return AdjustPlanes(adjustment, Measure(observations));
  }

  PlaneAdjustment adjustment;
  Observations observations;
};

// The errors of everything, squared, where the planes are turned and moved by
// numbers: the turn of the frame, the turn of the wall and the three shifts.
double CostOf(const AdjustedPlanes& at,
              const PlaneAdjustment& adjustment,
              const std::vector<PlaneMeasurement>& measurements,
              const Eigen::Matrix<double, 8, 1>& numbers) {
  WorldPlane moved[3];
  for (int p = 0; p < 3; ++p) {
    const ModelPlane& plane = at.planes[p];
    Vector3d turn = numbers.head<3>();
    if (p == 0) {
      turn = numbers[3] * plane.axis_s + numbers[4] * plane.axis_t;
    }
    Vector3d normal = plane.plane.normal;
    if (turn.norm() > 0.0) {
      normal = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * normal;
    }
    moved[p] = {normal, -normal.dot(plane.center) - numbers[5 + p]};
  }
  double cost = 0.0;
  for (const PlaneMeasurement& measurement : measurements) {
    const WorldPlane& plane = moved[measurement.plane];
    const Vector3d q = plane.normal / plane.Height(measurement.center);
    cost += q.homogeneous().dot(measurement.form * q.homogeneous());
  }
  for (const PlaneAnglePrior& angle : adjustment.angles) {
    const double cosine =
        moved[angle.first].normal.dot(moved[angle.second].normal);
    cost += std::pow(cosine / angle.sigma, 2);
  }
  return cost;
}

// Without noise it is twice the inverse of the second derivatives of the cost,
// which differences tell.
TEST(AdjustPlanes, CovarianceIsTheInverseCurvatureOfTheCost) {
  using Numbers = Eigen::Matrix<double, 8, 1>;
  const Corner corner(1.0, Vector3d::Zero(), /*has_noise=*/false);
  const MeasurePlanes measure = Measure(corner.observations);
  const AdjustedPlanes adjusted = AdjustPlanes(corner.adjustment, measure);
  std::vector<WorldPlane> planes;
  for (const ModelPlane& plane : adjusted.planes) {
    planes.push_back(plane.plane);
  }
  const std::vector<PlaneMeasurement> measurements = measure(planes);
  constexpr double kStep = 1e-4;
  const auto cost = [&](int i, double a, int k, double b) {
    const Numbers numbers = a * Numbers::Unit(i) + b * Numbers::Unit(k);
    return CostOf(adjusted, corner.adjustment, measurements, kStep * numbers);
  };
  Eigen::Matrix<double, 8, 8> curvature;
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 8; ++k) {
      curvature(i, k) = (cost(i, 1, k, 1) - cost(i, 1, k, -1) -
                         cost(i, -1, k, 1) + cost(i, -1, k, -1)) /
                        (4.0 * kStep * kStep);
    }
  }
  const Eigen::Matrix<double, 8, 8> covariance = 2.0 * curvature.inverse();
  for (int p = 0; p < 3; ++p) {
    Eigen::Matrix<double, 3, 8> by_numbers =
        Eigen::Matrix<double, 3, 8>::Zero();
    if (p == 0) {
      by_numbers(0, 3) = by_numbers(1, 4) = 1.0;
    } else {
      by_numbers.block<1, 3>(0, 0) = adjusted.planes[p].axis_s.transpose();
      by_numbers.block<1, 3>(1, 0) = adjusted.planes[p].axis_t.transpose();
    }
    by_numbers(2, 5 + p) = 1.0;
    const Eigen::Matrix3d expected =
        by_numbers * covariance * by_numbers.transpose();
    EXPECT_TRUE(adjusted.planes[p].covariance.isApprox(expected, 1e-3))
        << adjusted.planes[p].covariance << "\n\n"
        << expected;
  }
}

TEST(AdjustPlanesChecks, SameInputGivesSameBits) {
  const AdjustedPlanes a = Corner().Adjust();
  const AdjustedPlanes b = Corner().Adjust();
  for (int p = 0; p < 3; ++p) {
    ExpectSame(a.planes[p].plane, b.planes[p].plane);
    EXPECT_EQ(a.planes[p].center, b.planes[p].center);
    EXPECT_EQ(a.planes[p].axis_s, b.planes[p].axis_s);
    EXPECT_EQ(a.planes[p].covariance, b.planes[p].covariance);
  }
  EXPECT_EQ(a.frames[0], b.frames[0]);
}

TEST(AdjustPlanesChecks, PrintsNothing) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Corner corner;
  corner.Adjust();
  // Where no step is possible, too.
  corner.adjustment.planes[0] = PlaneThrough(Vector3d::UnitZ(), {0, 0, 1e-9});
  corner.Adjust();
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(AdjustPlanes, NeitherUnitNorOriginMatters) {
  const AdjustedPlanes a = Corner().Adjust();
  const struct {
    double scale;
    Vector3d origin;
    double tolerance;
  } kChanges[] = {{1.0 / 1024.0, Vector3d::Zero(), 1e-8},
                  {1024.0, Vector3d::Zero(), 1e-8},
                  {1.0, {3e5, -5e6, 2e5}, 1e-4}};
  for (const auto& change : kChanges) {
    const AdjustedPlanes b = Corner(change.scale, change.origin).Adjust();
    const Vector3d units(1.0, 1.0, 1.0 / change.scale);
    for (int p = 0; p < 3; ++p) {
      const ModelPlane& plane = b.planes[p];
      EXPECT_LT((a.planes[p].plane.normal - plane.plane.normal).norm(),
                0.01 * change.tolerance);
      const Vector3d center = change.scale * a.planes[p].center + change.origin;
      EXPECT_NEAR(plane.plane.Height(center) / change.scale,
                  0.0,
                  0.01 * change.tolerance);
      const Eigen::Matrix3d covariance =
          units.asDiagonal() * plane.covariance * units.asDiagonal();
      EXPECT_TRUE(covariance.isApprox(a.planes[p].covariance, change.tolerance))
          << p;
    }
  }
}

TEST(AdjustPlanesChecks, RefusesWhatIsNotFiniteOrOutOfRange) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<std::function<void(Corner*)>> defects = {
      [](Corner* c) { c->adjustment.planes[1].offset = kNan; },
      [](Corner* c) { c->adjustment.planes[1].normal.x() = kInfinity; },
      [](Corner* c) { c->adjustment.planes[1].normal *= 2.0; },
      [](Corner* c) { c->observations[1].second[3].depth = kNan; },
  };
  EXPECT_NO_THROW(Corner().Adjust());
  for (size_t i = 0; i < defects.size(); ++i) {
    Corner corner;
    defects[i](&corner);
    EXPECT_THROW(corner.Adjust(), std::invalid_argument) << i;
  }
  EXPECT_THROW(Corner(1e200).Adjust(), std::invalid_argument);
}

}  // namespace
}  // namespace tsar
