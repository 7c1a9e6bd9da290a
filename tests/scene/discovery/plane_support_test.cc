// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/plane_support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/synthetic_room.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr float kDepth = 4.f;
constexpr float kErrorPerDepth = 0.001f;
// The sigma of one superpixel by default: a quarter of a pixel of disparity.
constexpr double kSigma = 0.25 * kDepth * kDepth * kErrorPerDepth;

// A wall across the optical axis, at kDepth in the frame of a camera, whose
// superpixels are added one by one.
class PlaneSupportTest : public testing::Test {
 protected:
  PlaneSupportTest() {
    evidence_.resolution.error_per_depth = kErrorPerDepth;
    evidence_.first_observation.push_back(0);
    LookFrom(Camera());
    discovered_.assignment.resize(1);
  }

  void LookFrom(const Camera& camera) {
    camera_ = camera;
    discovered_.planes = {
        {ToWorldPlane({{0.f, 0.f, -1.f}, kDepth}, camera), 1.0}};
  }

  // Observations at positions on the wall.
  void AddSuperpixel(const std::vector<PlanePoint>& points,
                     float weight = 40.f,
                     float confidence = 1.f,
                     float depth = kDepth) {
    for (const PlanePoint& point : points) {
      evidence_.observations.push_back(
          {{point.s / kDepth, point.t / kDepth, depth}, confidence});
      evidence_.sources.push_back(ObservationSource::kMeasured);
    }
    evidence_.first_observation.push_back(
        static_cast<int>(evidence_.observations.size()));
    evidence_.weights.push_back(weight);
    discovered_.assignment[0].push_back(0);
  }

  // Four superpixels of one observation around the optical axis.
  void AddCorners(float s, float t, float weight = 40.f) {
    for (const float sign_s : {-1.f, 1.f}) {
      for (const float sign_t : {-1.f, 1.f}) {
        AddSuperpixel({{sign_s * s, sign_t * t}}, weight);
      }
    }
  }

  // count x count places, `step` apart, each with as many observations.
  void AddGrid(float s, float t, int count, float step, int repeated) {
    std::vector<PlanePoint> points;
    for (int row = 0; row < count; ++row) {
      for (int column = 0; column < count; ++column) {
        points.insert(
            points.end(), repeated, {s + column * step, t + row * step});
      }
    }
    AddSuperpixel(points);
  }

  PlaneSupport Find() const {
    return FindPlaneSupport(
        {{&evidence_, camera_}}, discovered_, tolerance_, num_cells_);
  }

  // The position of a cell on the wall.
  static PlanePoint OnWall(const PlaneSupport& support,
                           const PlanePoint& cell) {
    const PlaneFrame& frame = support.frames[0];
    const Vec3f point =
        frame.center + frame.axis_s * cell.s + frame.axis_t * cell.t;
    return {point.x, point.y};
  }

  // Cells lie along the frame's axes, so that their corners may point anywhere.
  static bool HasCellAt(const PlaneSupport& support, float s, float t) {
    const float reach = 0.75f * support.cell_sizes[0];
    return std::any_of(support.cells.begin(),
                       support.cells.end(),
                       [&](const PlanePoint& cell) {
                         const PlanePoint point = OnWall(support, cell);
                         return std::hypot(point.s - s, point.t - t) <= reach;
                       });
  }

  ViewEvidence evidence_;
  Camera camera_;
  DiscoveredPlanes discovered_;
  double tolerance_ = 1.0;
  int num_cells_ = 64;
};

TEST_F(PlaneSupportTest, KnowsAPlaneAsItsSuperpixelsDo) {
  AddCorners(2.f, 1.f);
  const PlaneFrame frame = Find().frames[0];
  EXPECT_NEAR(frame.height_variance / (kSigma * kSigma), 0.25f, 1e-4f);
  EXPECT_NEAR(frame.slope_variance_s / (kSigma * kSigma), 0.0625f, 1e-4f);
  EXPECT_NEAR(frame.slope_variance_t / (kSigma * kSigma), 0.25f, 1e-4f);
  EXPECT_NEAR(frame.Sigma({2.f, 0.f}), kSigma * std::sqrt(0.5f), 1e-6f);
  EXPECT_NEAR(frame.Sigma({0.f, -1.f}), kSigma * std::sqrt(0.5f), 1e-6f);
  EXPECT_NEAR(
      frame.Sigma({6.f, 4.f}), kSigma * std::sqrt(0.25f + 2.25f + 4.f), 1e-5f);
}

TEST_F(PlaneSupportTest, SuperpixelsCountByTheirWeightUpToOne) {
  AddCorners(2.f, 1.f, 10.f);
  EXPECT_NEAR(Find().frames[0].height_variance / (kSigma * kSigma), 1.f, 1e-4f);
  std::fill(evidence_.weights.begin(), evidence_.weights.end(), 1000.f);
  EXPECT_NEAR(
      Find().frames[0].height_variance / (kSigma * kSigma), 0.25f, 1e-4f);
}

TEST_F(PlaneSupportTest, WeakObservationsAndThoseOffThePlaneMeasureNothing) {
  const std::vector<PlanePoint> points(4, {0.f, 0.f});
  AddSuperpixel(points);
  // Inliers have 2 of the 2.5 confidences, and then, with one off the plane, 1.
  evidence_.observations[2].confidence = 0.25f;
  evidence_.observations[3].confidence = 0.25f;
  EXPECT_NEAR(
      Find().frames[0].height_variance / (kSigma * kSigma), 1.25f, 1e-4f);
  evidence_.observations[1].sample.z = 1.02f * kDepth;
  EXPECT_NEAR(
      Find().frames[0].height_variance / (kSigma * kSigma), 2.5f, 1e-4f);
}

TEST_F(PlaneSupportTest, FramesLieOnTheirPlanesInTheReferencesFrame) {
  AddCorners(2.f, 1.f);
  for (const double distance : {0.0, 10.0, 1e6}) {
    Camera camera = CameraLookingAt({distance, -2.0, 0.7 * distance},
                                    {0.3 + distance, 3.0, 4.0});
    LookFrom(camera);
    const PlaneFrame frame = Find().frames[0];
    EXPECT_LT(Norm(frame.center - Vec3f{0.f, 0.f, kDepth}), 1e-4f);
    EXPECT_NEAR(std::abs(frame.axis_s.x), 1.f, 1e-4f);
    EXPECT_NEAR(std::abs(frame.axis_t.y), 1.f, 1e-4f);
    EXPECT_NEAR(frame.height_variance / (kSigma * kSigma), 0.25f, 1e-3f);
    const PlanePoint point = frame.Coordinates({2.f, 1.f, kDepth});
    EXPECT_NEAR(std::abs(point.s), 2.f, 1e-3f);
    EXPECT_NEAR(std::abs(point.t), 1.f, 1e-3f);
  }
}

TEST_F(PlaneSupportTest, CellsLieWhereThePlaneWasObserved) {
  AddGrid(-2.f, -1.f, 10, 0.05f, 2);
  AddGrid(1.5f, 0.5f, 10, 0.05f, 2);
  num_cells_ = 32;
  for (const Camera& camera :
       {Camera(), CameraLookingAt({7.0, -2.0, 3.0}, {0.3, 3.0, 4.0})}) {
    LookFrom(camera);
    const PlaneSupport support = Find();
    EXPECT_EQ(support.first_cell, (std::vector<int>{0, support.first_cell[1]}));
    EXPECT_EQ(support.cells.size(), static_cast<size_t>(support.first_cell[1]));
    EXPECT_GT(support.cells.size(), 20u);
    for (int row = 0; row < 10; ++row) {
      for (int column = 0; column < 10; ++column) {
        const float s = 0.05f * column;
        const float t = 0.05f * row;
        EXPECT_TRUE(HasCellAt(support, s - 2.f, t - 1.f));
        EXPECT_TRUE(HasCellAt(support, s + 1.5f, t + 0.5f));
      }
    }
    for (const PlanePoint& cell : support.cells) {
      const PlanePoint point = OnWall(support, cell);
      EXPECT_TRUE(point.s < -1.4f || point.s > 1.4f);
      EXPECT_TRUE(point.t < -0.4f || point.t > 0.4f);
    }
  }
}

TEST_F(PlaneSupportTest, CellsThatWereHardlySeenHoldNoise) {
  AddGrid(0.f, 0.f, 8, 0.1f, 15);
  AddSuperpixel({{3.f, 0.f}});
  AddSuperpixel({{0.f, 3.f}, {0.f, 3.f}});
  EXPECT_TRUE(HasCellAt(Find(), 0.3f, 0.3f));
  EXPECT_FALSE(HasCellAt(Find(), 3.f, 0.f));
  EXPECT_TRUE(HasCellAt(Find(), 0.f, 3.f));
  // If cells were seen 175 times, two observations are noise.
  for (int i = 0; i < 8; ++i) {
    AddGrid(0.f, 0.f, 8, 0.1f, 20);
  }
  EXPECT_TRUE(HasCellAt(Find(), 0.3f, 0.3f));
  EXPECT_FALSE(HasCellAt(Find(), 0.f, 3.f));
}

TEST_F(PlaneSupportTest, MoreViewsKnowThePlanesOfARoomBetter) {
  const SyntheticRoom room;
  DiscoveredPlanes discovered;
  for (const DrawnSurface& surface : room.surfaces) {
    discovered.planes.push_back({surface.plane, 1.0});
  }
  discovered.assignment = room.seen;
  const PlaneSupport all = FindPlaneSupport(room.Views(), discovered, 1.0);
  discovered.assignment.resize(1);
  const PlaneSupport one = FindPlaneSupport({room.Views()[0]}, discovered, 1.0);
  ASSERT_EQ(all.frames.size(), 3u);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_LT(all.frames[k].Sigma({}), 0.003f);
    EXPECT_GT(one.frames[k].height_variance,
              1.5f * all.frames[k].height_variance);
    EXPECT_GT(all.first_cell[k + 1], all.first_cell[k] + 50);
  }
}

TEST_F(PlaneSupportTest, KnowsNothingBesideALineOrAPoint) {
  AddSuperpixel(std::vector<PlanePoint>(5, {1.f, 0.5f}));
  const PlaneSupport at_point = Find();
  EXPECT_TRUE(at_point.cells.empty());
  EXPECT_LT(Norm(at_point.frames[0].center - Vec3f{1.f, 0.5f, kDepth}), 1e-5f);
  EXPECT_NEAR(at_point.frames[0].Sigma({}), kSigma, 1e-6f);
  EXPECT_GT(at_point.frames[0].Sigma({0.01f, 0.f}), 1e6f);
  EXPECT_GT(at_point.frames[0].Sigma({0.f, 0.01f}), 1e6f);

  for (int i = 0; i < 10; ++i) {
    AddSuperpixel(std::vector<PlanePoint>(5, {1.f + i, 0.5f}));
  }
  const PlaneSupport on_line = Find();
  EXPECT_LT(on_line.frames[0].Sigma({3.f, 0.f}), kSigma);
  EXPECT_GT(on_line.frames[0].Sigma({3.f, 0.01f}), 1e6f);
  EXPECT_EQ(on_line.cells.size(), 10u);
  EXPECT_TRUE(HasCellAt(on_line, 4.f, 0.5f));
}

TEST_F(PlaneSupportTest, WithoutMeasurementsKnowsJustWhereAPlaneIs) {
  AddGrid(-1.f, -1.f, 5, 0.5f, 3);
  for (Observation& observation : evidence_.observations) {
    observation.confidence = 0.3f;
  }
  const PlaneSupport support = Find();
  const PlaneFrame& frame = support.frames[0];
  EXPECT_LT(Norm(frame.center - Vec3f{0.f, 0.f, kDepth}), 1e-5f);
  EXPECT_NEAR(Norm(frame.axis_s), 1.f, 1e-5f);
  EXPECT_NEAR(Norm(frame.axis_t), 1.f, 1e-5f);
  EXPECT_NEAR(Dot(frame.axis_s, frame.axis_t), 0.f, 1e-6f);
  EXPECT_NEAR(frame.axis_s.z, 0.f, 1e-6f);
  EXPECT_NEAR(frame.axis_t.z, 0.f, 1e-6f);
  EXPECT_GT(frame.Sigma({}), 1e6f);
  EXPECT_TRUE(std::isfinite(frame.Sigma({100.f, 100.f})));
  EXPECT_TRUE(HasCellAt(support, 0.5f, -0.5f));
}

TEST_F(PlaneSupportTest, LeavesOutDepthsOffThePlaneOrNotFinite) {
  for (const float depth : {1.02f * kDepth,
                            0.98f * kDepth,
                            std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()}) {
    AddSuperpixel({{1.f, 1.f}, {1.f, 1.f}, {2.f, 1.f}}, 40.f, 1.f, depth);
  }
  const PlaneSupport support = Find();
  EXPECT_TRUE(support.cells.empty());
  EXPECT_EQ(support.cell_sizes, std::vector<float>{0.f});
  EXPECT_GT(support.frames[0].Sigma({}), 1e6f);

  AddCorners(2.f, 1.f);
  const PlaneSupport with_corners = Find();
  EXPECT_LT(Norm(with_corners.frames[0].center - Vec3f{0.f, 0.f, kDepth}),
            1e-5f);
  EXPECT_NEAR(with_corners.frames[0].Sigma({}), 0.5f * kSigma, 1e-6f);
}

}  // namespace
}  // namespace tsar
