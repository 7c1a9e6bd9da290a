// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/adjustment/adjust_planes.h"

#include <cmath>
#include <utility>
#include <vector>

#include "tests/scene/adjustment/adjust_planes_fixture.h"
#include <Eigen/LU>
#include <gtest/gtest.h>

namespace tsar {
namespace {

using Eigen::Vector3d;

const Patch kWall = {{0.0, 0.0, 5.0}, {2.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
const Patch kFloor = {{0.0, -1.5, 3.0}, {0.0, 0.0, 1.5}, {2.0, 0.0, 0.0}};
const Patch kSide = {{3.0, 0.0, 2.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
const Vector3d kCenters[] = {{0.1, 0.2, -0.3},
                             {-0.8, 0.1, 0.0},
                             {0.9, 0.3, 0.1},
                             {-0.3, -0.4, 0.4},
                             {0.4, 0.6, -0.2}};

// A scene with planes that views measure.
class AdjustModelTest : public testing::Test {
 protected:
  int AddPlane(const WorldPlane& plane, int axis = -1) {
    ModelPlane& added = model_.planes.emplace_back();
    added.plane = plane;
    added.axis = axis;
    added.frame = axis < 0 ? -1 : 0;
    return static_cast<int>(model_.planes.size()) - 1;
  }

  void Observe(int plane,
               const Patch& patch,
               const Bias& bias = {},
               Philox* random = nullptr) {
    for (const Vector3d& center : kCenters) {
      observations_.emplace_back(plane,
                                 ObservePatch(patch, center, 10, bias, random));
    }
  }

  // Planes of which only those of component 0 may move.
  void Adjust(const MeasurePlaneOptions& options = {}) {
    std::vector<bool> may_move;
    for (const ModelPlane& plane : model_.planes) {
      may_move.push_back(plane.component == 0);
    }
    AdjustModel(Measure(observations_, options), may_move, &model_);
  }

  // A wall that leans, since its upper half seems nearer, and a floor.
  void MakeLeaningWall(int axis_of_wall, int axis_of_floor) {
    AddPlane(kFloor.Plane(), axis_of_floor);
    AddPlane(kWall.Plane(), axis_of_wall);
    for (const double side : {-1.0, 1.0}) {
      Observe(1,
              {{0.0, 0.3 * side, 5.0}, {2.0, 0.0, 0.0}, {0.0, 0.05, 0.0}},
              {.shift = side});
    }
    Observe(0, kFloor);
  }
  double LeanOfWall() const {
    return AngleBetween(model_.planes[1].plane, kWall.Plane());
  }

  // The free wall, a floor and another wall in a frame, all displaced.
  void MakeCorner(Philox* random) {
    const Patch patches[] = {kWall, kFloor, kSide};
    const int axes[] = {-1, 1, 0};
    for (int p = 0; p < 3; ++p) {
      AddPlane(Displaced(patches[p].Plane(), patches[p].middle, 1.0, 0.1),
               axes[p]);
      Observe(p, patches[p], {}, random);
    }
    model_.frames = {
        Eigen::AngleAxisd(0.01, Vector3d::UnitX()).toRotationMatrix()};
  }

  SceneModel model_;
  Observations observations_;
};

bool IsUnknown(const Eigen::Matrix3d& covariance) {
  Eigen::Matrix3d finite = covariance;
  finite.diagonal().setZero();
  return finite.isZero(0.0) && covariance.diagonal().array().isInf().all();
}

void ExpectNear(const WorldPlane& a, const WorldPlane& b, double tolerance) {
  EXPECT_LT((a.normal - b.normal).norm(), tolerance);
  EXPECT_NEAR(a.offset, b.offset, tolerance);
}

// Alone, tied to each other, and measured edge-on.
TEST_F(AdjustModelTest, UndeterminedPlanesStay) {
  AddPlane(kFloor.Plane());
  AddPlane(Displaced(kWall.Plane(), kCenters[0], 2.0, 3.0));
  AddPlane(PlaneThrough({0.3, 0.6, 0.2}, kCenters[0]));
  observations_.emplace_back(2, ObservePatch(kWall, kCenters[0], 10));
  const std::vector<ModelPlane> before = model_.planes;
  Adjust();
  for (size_t p = 0; p < before.size(); ++p) {
    ExpectNear(model_.planes[p].plane, before[p].plane, 1e-9);
    EXPECT_TRUE(IsUnknown(model_.planes[p].covariance)) << p;
  }
}

TEST_F(AdjustModelTest, APlaneMeasuredOnALineTurnsNotAboutIt) {
  const Vector3d normal =
      Eigen::AngleAxisd(Radians(2.0), Vector3d::UnitX()) * Vector3d::UnitZ();
  AddPlane(PlaneThrough(normal, kWall.middle + Vector3d(0.0, 0.0, 0.1)));
  Observe(0, {kWall.middle, {2.0, 0.0, 0.0}, {0.0, 0.0, 0.0}});
  Adjust();
  const ModelPlane& plane = model_.planes[0];
  EXPECT_LT(plane.plane.normal.cross(normal).norm(), 1e-3);
  EXPECT_NEAR(plane.plane.Height(kWall.middle), 0.0, 1e-3);
  EXPECT_LT(plane.axis_t.cross(Vector3d::UnitX()).norm(), 1e-4);
  EXPECT_LT(plane.covariance(0, 0), 1e-3);
  EXPECT_TRUE(std::isinf(plane.covariance(1, 1)));
  EXPECT_LT(plane.covariance(2, 2), 1e-3);
  EXPECT_EQ(plane.covariance(0, 1), 0.0);
}

TEST_F(AdjustModelTest, AFrameUprightsAWallThatLeansAlone) {
  // A component of its own is not tied to the floor.
  MakeLeaningWall(-1, -1);
  AddPlane({});
  model_.planes[0].component = 1;
  Adjust();
  EXPECT_GT(LeanOfWall(), 3.0);

  model_.planes.clear();
  MakeLeaningWall(2, 1);
  model_.frames = {
      Eigen::AngleAxisd(0.02, Vector3d::UnitX()).toRotationMatrix()};
  Adjust();
  EXPECT_LT(LeanOfWall(), 0.6);
  // Exactly along the frame, on the side where it was.
  const Vector3d wall = model_.planes[1].plane.normal;
  const Vector3d axis = model_.frames[0].col(2);
  EXPECT_TRUE(wall == axis || wall == -axis);
  EXPECT_GT(wall.dot(kWall.Plane().normal), 0.9);
  // The floor determines the rotation that would let the wall lean.
  EXPECT_LT(model_.planes[1].covariance.trace(), 1e-2);
}

// Whether the tie is to the floor or to another wall back to back with it, but
// not where the measurements are certain.
TEST_F(AdjustModelTest, ATieDecidesWhereEvidenceIsWeak) {
  for (const double weakness : {1.0, 20.0}) {
    for (const bool is_parallel : {false, true}) {
      SCOPED_TRACE(weakness);
      model_ = {};
      observations_.clear();
      const Patch back = {{0.0, 0.0, -5.0}, {2.0, 0.0, 0.0}, {0.0, -1.0, 0.0}};
      const Patch& other = is_parallel ? back : kFloor;
      // It leans by 2.5 degrees, five standard deviations of the tie.
      Patch wall = kWall;
      wall.half_width = {0.0, std::cos(Radians(2.5)), std::sin(Radians(2.5))};
      AddPlane(other.Plane());
      AddPlane(wall.Plane());
      Observe(0, other);
      Observe(1, wall);
      for (auto& [plane, of_view] : observations_) {
        for (DepthObservation& observation : of_view) {
          observation.sigma *= plane == 1 ? weakness : 1.0;
        }
      }
      Adjust();
      EXPECT_EQ(LeanOfWall() > 2.0, weakness < 2.0) << LeanOfWall();
    }
  }
}

TEST_F(AdjustModelTest, PlanesThatMayNotMoveStay) {
  Philox random(1, 2, 3);
  MakeCorner(&random);
  for (ModelPlane& plane : model_.planes) {
    plane.component = 1;
  }
  // One of them is exactly along its axis.
  model_.planes[2].plane = PlaneThrough(model_.frames[0].col(0), kSide.middle);
  const SceneModel before = model_;
  Adjust();
  EXPECT_EQ(model_.frames, before.frames);
  for (int p = 0; p < 3; ++p) {
    ExpectNear(model_.planes[p].plane, before.planes[p].plane, 0.0 + 1e-300);
    EXPECT_TRUE(model_.planes[p].covariance.allFinite());
    EXPECT_NEAR(
        model_.planes[p].plane.Height(model_.planes[p].center), 0.0, 1e-9);
    EXPECT_EQ(model_.planes[p].axis, p == 2 ? 0 : -1);
  }
}

// With noise alone and with errors common to each view, for a single plane and
// for planes in a frame.
TEST_F(AdjustModelTest, CovarianceTellsTheErrors) {
  const std::pair<double, bool> cases[] = {
      {0.0, false}, {0.5, false}, {0.0, true}};
  for (const auto& [common, is_framed] : cases) {
    SCOPED_TRACE(common);
    MeasurePlaneOptions options;
    options.common_deviation = common;
    Vector3d squares = Vector3d::Zero();
    constexpr int kDraws = 200;
    for (int draw = 0; draw < kDraws; ++draw) {
      Philox random(draw, 7, 3);
      model_ = {};
      observations_.clear();
      AddPlane(is_framed ? kWall.Plane()
                         : Displaced(kWall.Plane(), kWall.middle, 0.3, 0.02),
               is_framed ? 2 : -1);
      if (is_framed) {
        model_.frames = {Eigen::Matrix3d::Identity()};
        AddPlane(kFloor.Plane(), 1);
        Observe(1, kFloor, {}, &random);
      }
      for (const Vector3d& center : kCenters) {
        // u and v have a deviation of 0.63 over the patch.
        const double shift = common * NextNormal(&random);
        const double lean_u = common * NextNormal(&random) / 0.63;
        const double lean_v = common * NextNormal(&random) / 0.63;
        observations_.emplace_back(
            0,
            ObservePatch(kWall, center, 10, {shift, lean_u, lean_v}, &random));
      }
      Adjust(options);
      const ModelPlane& plane = model_.planes[0];
      squares += ErrorOf(plane, kWall.Plane())
                     .cwiseAbs2()
                     .cwiseQuotient(plane.covariance.diagonal());
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(std::sqrt(squares[i] / kDraws), 0.7) << i;
      EXPECT_LT(std::sqrt(squares[i] / kDraws), 1.4) << i;
    }
  }
}

TEST_F(AdjustModelTest, NeitherTheUnitNorTheOriginMatters) {
  Philox random(5, 6, 7);
  MakeCorner(&random);
  const SceneModel model = model_;
  const Observations observations = observations_;
  Adjust();
  const SceneModel expected = model_;
  const std::pair<double, Vector3d> cases[] = {
      {1e-4, {0.0, 0.0, 0.0}}, {1e4, {0.0, 0.0, 0.0}}, {1.0, {3e5, -2e5, 1e5}}};
  for (const auto& [scale, origin] : cases) {
    SCOPED_TRACE(scale);
    model_ = model;
    observations_ = observations;
    for (ModelPlane& plane : model_.planes) {
      plane.plane.offset =
          scale * plane.plane.offset - plane.plane.normal.dot(origin);
    }
    for (auto& [plane, of_view] : observations_) {
      for (DepthObservation& observation : of_view) {
        observation.center = scale * observation.center + origin;
        observation.depth *= scale;
        observation.sigma *= scale;
      }
    }
    Adjust();
    for (int p = 0; p < 3; ++p) {
      const ModelPlane& a = expected.planes[p];
      const ModelPlane& b = model_.planes[p];
      EXPECT_LT((a.plane.normal - b.plane.normal).norm(), 1e-6);
      EXPECT_LT((scale * a.center + origin - b.center).norm(), 1e-4 * scale);
      EXPECT_NEAR(b.covariance(0, 0) / a.covariance(0, 0), 1.0, 1e-3);
      EXPECT_NEAR(
          b.covariance(2, 2) / (scale * scale * a.covariance(2, 2)), 1.0, 1e-3);
    }
  }
}

}  // namespace
}  // namespace tsar
