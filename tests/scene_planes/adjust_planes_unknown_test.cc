// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/adjust_planes.h"

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

#include "tests/scene_planes/adjust_planes_fixture.h"
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

// The segment in which wall and floor meet, as the camera sees it.
PlaneCrease Crease() {
  return {
      0,
      1,
      kCenter,
      {Vector3d(-1.5, -1.5, 5.0) - kCenter, Vector3d(1.0, -1.5, 5.0) - kCenter},
      0.002};
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

TEST(AdjustPlanesUnknown, TwoUnmeasuredPlanesThatMeetStay) {
  PlaneAdjustment adjustment;
  adjustment.planes = {kWall.Plane(),
                       Displaced(kFloor.Plane(), kFloor.middle, 3.0, 0.1)};
  adjustment.creases = {Crease()};
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
  const AdjustedPlane plane =
      AdjustPlanes(adjustment, Measure(observations)).planes[0];
  EXPECT_LT(plane.plane.normal.cross(normal).norm(), 1e-3);
  EXPECT_NEAR(plane.plane.Height(kWall.middle), 0.0, 1e-3);
  EXPECT_LT(plane.axis_t.cross(Vector3d::UnitX()).norm(), 1e-4);
  EXPECT_LT(plane.covariance(0, 0), 1e-3);
  EXPECT_TRUE(std::isinf(plane.covariance(1, 1)));
  EXPECT_LT(plane.covariance(2, 2), 1e-3);
  EXPECT_EQ(plane.covariance(0, 1), 0.0);
}

TEST(AdjustPlanesUnknown, CreasePlacesAnUnmeasuredPlane) {
  // The floor lies 0.4 too low; nothing but where it meets the wall tells.
  PlaneAdjustment adjustment;
  adjustment.planes = {kWall.Plane(),
                       PlaneThrough(Vector3d::UnitY(), {0.0, -1.9, 0.0})};
  adjustment.creases = {Crease()};
  const Observations observations = {{0, ObservePatch(kWall, kCenter, 10)},
                                     {0, ObservePatch(kWall, {1, 1, 0}, 10)}};
  for (const bool framed : {false, true}) {
    if (framed) {
      adjustment.frames = {Eigen::Matrix3d::Identity()};
      adjustment.axes = {{0, 2}, {0, 1}};
    }
    const AdjustedPlane floor =
        AdjustPlanes(adjustment, Measure(observations)).planes[1];
    EXPECT_NEAR(floor.plane.Height({-0.25, -1.5, 5.0}), 0.0, 0.01) << framed;
    EXPECT_LT(std::sqrt(floor.covariance(2, 2)), 0.02) << framed;
    if (framed) {
      EXPECT_LT(AngleBetween(floor.plane, kFloor.Plane()), 0.2);
      EXPECT_LT(floor.covariance.trace(), 1e-2);
    } else {
      // About the crease.
      EXPECT_TRUE(std::isinf(floor.covariance(1, 1)));
    }
  }
}

TEST(AdjustPlanesUnknown, PlaneThroughACameraIsLeftOut) {
  PlaneAdjustment adjustment;
  adjustment.planes = {PlaneThrough(Vector3d::UnitY(), kCenter),
                       PlaneThrough(Vector3d::UnitZ(), kCenter)};
  adjustment.creases = {Crease()};
  const Observations observations = {{0, ObservePatch(kWall, kCenter, 10)}};
  const AdjustedPlanes adjusted =
      AdjustPlanes(adjustment, Measure(observations));
  ExpectSame(adjusted.planes[0].plane, adjustment.planes[0]);
  EXPECT_TRUE(IsUnknown(adjusted.planes[0].covariance));
}

// A wall and a floor with all that there is to know of them.
struct Corner {
  explicit Corner(double scale = 1.0,
                  const Vector3d& origin = Vector3d::Zero()) {
    const auto moved = [&](const Vector3d& point) {
      return Vector3d(scale * point + origin);
    };
    Philox random(5, 6, 7);
    for (const Vector3d& center : {Vector3d(0, 0, 0), Vector3d(1, 1, 0)}) {
      observations.emplace_back(0, ObservePatch(kWall, center, 8, {}, &random));
      observations.emplace_back(1,
                                ObservePatch(kFloor, center, 8, {}, &random));
    }
    for (auto& [plane, of_view] : observations) {
      for (DepthObservation& observation : of_view) {
        observation.center = moved(observation.center);
        observation.depth *= scale;
        observation.sigma *= scale;
      }
    }
    for (const WorldPlane& plane :
         {Displaced(kWall.Plane(), kWall.middle, 1.0, 0.1),
          Displaced(kFloor.Plane(), kFloor.middle, 1.0, 0.1),
          PlaneThrough(Vector3d::UnitX(), {3.0, 0.0, 0.0})}) {
      adjustment.planes.push_back(
          {plane.normal, scale * plane.offset - plane.normal.dot(origin)});
    }
    for (int i = 0; i < 9; ++i) {
      adjustment.points.push_back(
          {0,
           moved({i % 3 - 1.0, i / 3 - 1.0, 5.0 + 0.01 * (i % 2)}),
           0.02 * scale});
      adjustment.points.push_back(
          {2,
           moved({3.0 + 0.01 * (i % 2), i / 3 - 1.0, i % 3 + 1.0}),
           0.02 * scale});
    }
    adjustment.creases = {Crease()};
    adjustment.creases[0].center = moved(kCenter);
    adjustment.frames = {
        Eigen::AngleAxisd(0.01, Vector3d::UnitX()).toRotationMatrix()};
    adjustment.axes = {{-1, -1}, {0, 1}, {0, 0}};
    adjustment.angles = {{PlaneAnglePrior::Kind::kOrthogonal, 0, 1, 0.01}};
  }

  AdjustedPlanes Adjust() const {
    return AdjustPlanes(adjustment, Measure(observations));
  }

  PlaneAdjustment adjustment;
  Observations observations;
};

TEST(AdjustPlanesUnits, SameInputGivesSameBits) {
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

TEST(AdjustPlanesUnits, OnePointFarAwayDoesNotMatter) {
  const AdjustedPlanes a = Corner().Adjust();
  Corner corner;
  corner.adjustment.points.push_back({0, {1e12, 1e12, 1e12}, 0.02});
  const AdjustedPlanes b = corner.Adjust();
  for (int p = 0; p < 3; ++p) {
    EXPECT_LT(SquaredError(b.planes[p], a.planes[p].plane), 0.01);
    EXPECT_TRUE(b.planes[p].covariance.isApprox(a.planes[p].covariance, 0.01));
  }
}

TEST(AdjustPlanesUnits, PrintsNothing) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Corner corner;
  corner.Adjust();
  // Where no step is possible, too.
  corner.adjustment.planes[0] = PlaneThrough(Vector3d::UnitZ(), {0, 0, 1e-9});
  corner.adjustment.points[0].sigma = 1e-250;
  try {
    corner.Adjust();
  } catch (const std::invalid_argument&) {
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(AdjustPlanesUnits, UnitOfLengthDoesNotMatter) {
  const AdjustedPlanes a = Corner().Adjust();
  for (const double scale : {1.0 / 1024.0, 1024.0}) {
    const AdjustedPlanes b = Corner(scale).Adjust();
    const Vector3d units(1.0, 1.0, 1.0 / scale);
    for (int p = 0; p < 3; ++p) {
      EXPECT_LT((a.planes[p].plane.normal - b.planes[p].plane.normal).norm(),
                1e-12);
      EXPECT_NEAR(
          a.planes[p].plane.offset, b.planes[p].plane.offset / scale, 1e-12);
      const Eigen::Matrix3d covariance =
          units.asDiagonal() * b.planes[p].covariance * units.asDiagonal();
      EXPECT_TRUE(covariance.isApprox(a.planes[p].covariance, 1e-8)) << p;
    }
  }
}

TEST(AdjustPlanesUnits, PlaceOfTheOriginDoesNotMatter) {
  const AdjustedPlanes a = Corner().Adjust();
  const Vector3d origin(3e5, -5e6, 2e5);
  const AdjustedPlanes b = Corner(1.0, origin).Adjust();
  for (int p = 0; p < 3; ++p) {
    EXPECT_LT((a.planes[p].plane.normal - b.planes[p].plane.normal).norm(),
              1e-6);
    EXPECT_NEAR(
        b.planes[p].plane.Height(a.planes[p].center + origin), 0.0, 1e-6);
    EXPECT_TRUE(b.planes[p].covariance.isApprox(a.planes[p].covariance, 1e-4));
  }
}

TEST(AdjustPlanesChecks, RefusesWhatIsNotFiniteOrOutOfRange) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<std::function<void(Corner*)>> defects = {
      [](Corner* c) { c->adjustment.planes[1].offset = kNan; },
      [](Corner* c) { c->adjustment.planes[1].normal.x() = kInfinity; },
      [](Corner* c) { c->adjustment.planes[1].normal *= 2.0; },
      [](Corner* c) { c->adjustment.frames[0] *= 1.1; },
      [](Corner* c) { c->adjustment.frames[0] *= -1.0; },
      [](Corner* c) { c->adjustment.frames[0](0, 0) = kNan; },
      [](Corner* c) { c->adjustment.axes.pop_back(); },
      [](Corner* c) { c->adjustment.axes[1].frame = 1; },
      [](Corner* c) { c->adjustment.axes[1].column = 3; },
      [](Corner* c) { c->adjustment.points[2].plane = 3; },
      [](Corner* c) { c->adjustment.points[2].point.z() = kNan; },
      [](Corner* c) { c->adjustment.points[2].sigma = 0.0; },
      [](Corner* c) { c->adjustment.creases[0].second = 0; },
      [](Corner* c) { c->adjustment.creases[0].second = -1; },
      [](Corner* c) { c->adjustment.creases[0].rays[1].x() = kNan; },
      [](Corner* c) { c->adjustment.creases[0].relative_sigma = kInfinity; },
      [](Corner* c) { c->adjustment.angles[0].first = 7; },
      [](Corner* c) { c->adjustment.angles[0].sigma = -1.0; },
      [](Corner* c) { c->observations[1].second[3].depth = kNan; },
  };
  EXPECT_NO_THROW(Corner().Adjust());
  for (size_t i = 0; i < defects.size(); ++i) {
    Corner corner;
    defects[i](&corner);
    EXPECT_THROW(corner.Adjust(), std::invalid_argument) << i;
  }
  const Corner corner;
  for (const int plane : {-1, 3}) {
    const auto measure = [&](const std::vector<WorldPlane>& planes) {
      auto measurements = Measure(corner.observations)(planes);
      measurements[0].plane = plane;
      return measurements;
    };
    EXPECT_THROW(AdjustPlanes(corner.adjustment, measure),
                 std::invalid_argument);
  }
  EXPECT_THROW(
      {
        Corner huge(1e200);
        huge.Adjust();
      },
      std::invalid_argument);
  EXPECT_THROW(AdjustPlanes({}, MeasureNothing, {.max_rounds = 0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace tsar
