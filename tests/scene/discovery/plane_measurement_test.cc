// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/plane_measurement.h"

#include <cmath>
#include <vector>

#include "tests/scene/adjustment/adjust_planes_fixture.h"
#include "tests/support/synthetic_room.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

using Eigen::Vector3d;

const Patch kPatch = {{0.5, 0.2, 4.0}, {1.0, 0.0, 0.3}, {0.0, 1.0, 0.1}};
const Vector3d kCenter(0.3, -0.2, 0.1);
// Least squares of independent errors.
constexpr MeasurePlaneOptions kSquares = {1e6, 0.0};

// The squared error of a plane's inverse depths, in expected errors.
double Cost(const PlaneMeasurement& measurement, const WorldPlane& plane) {
  Eigen::Vector4d q;
  q << plane.normal / plane.Height(measurement.center), 1.0;
  return q.dot(measurement.form * q);
}

TEST(MeasurePlane, FormIsTheSumOfSquaredErrors) {
  Philox random(1, 1, 1);
  const auto observations = ObservePatch(kPatch, kCenter, 6, {}, &random);
  const PlaneMeasurement measurement =
      MeasurePlane(3, kPatch.Plane(), observations, kSquares);
  EXPECT_EQ(measurement.plane, 3);
  EXPECT_EQ(measurement.center, observations[0].center);
  for (const double height : {0.0, 0.05, -0.2}) {
    const WorldPlane plane =
        Displaced(kPatch.Plane(), kPatch.middle, 2.0, height);
    double sum = 0.0;
    for (const DepthObservation& observation : observations) {
      const double depth =
          -plane.Height(observation.center) / plane.normal.dot(observation.ray);
      const double sigma =
          observation.sigma / (observation.depth * observation.depth);
      sum += std::pow((1.0 / depth - 1.0 / observation.depth) / sigma, 2);
    }
    EXPECT_NEAR(Cost(measurement, plane), sum, 1e-9 * sum);
  }
}

TEST(MeasurePlane, ManyObservationsWithACommonErrorInformAsFew) {
  const auto information = [&](int count, double common) {
    return MeasurePlane(0,
                        kPatch.Plane(),
                        ObservePatch(kPatch, kCenter, count),
                        {1e6, common})
        .information;
  };
  EXPECT_NEAR(information(20, 0.0) / information(5, 0.0), 16.0, 1.0);
  EXPECT_NEAR(information(20, 0.5) / information(5, 0.5), 1.15, 0.05);
  // 100 of them: 1 / 100 + 1 / 4.
  EXPECT_NEAR(information(10, 0.5) / information(10, 0.0), 1.0 / 26.0, 1e-9);
}

TEST(MeasurePlane, OutliersHaveLittleSay) {
  auto observations = ObservePatch(kPatch, kCenter, 6);
  const PlaneMeasurement clean =
      MeasurePlane(0, kPatch.Plane(), observations, {1.0, 0.0});
  for (int i = 0; i < 5; ++i) {
    observations[7 * i].depth *= 0.5;
  }
  const PlaneMeasurement spoilt =
      MeasurePlane(0, kPatch.Plane(), observations, {1.0, 0.0});
  EXPECT_LT(spoilt.information, clean.information);
  EXPECT_GT(spoilt.information, 0.8 * clean.information);
  // If the whole view errs, its common error does not preserve its influence.
  for (DepthObservation& observation : observations) {
    observation.depth *= 0.9;
  }
  const MeasurePlaneOptions options;
  EXPECT_LT(
      MeasurePlane(0, kPatch.Plane(), observations, options).information,
      0.05 * MeasurePlane(
                 0, kPatch.Plane(), ObservePatch(kPatch, kCenter, 6), options)
                 .information);
}

TEST(MeasurePlane, NormalErrorsInformAlikeWithAnyLoss) {
  Philox random(2, 1, 1);
  const auto observations = ObservePatch(kPatch, kCenter, 60, {}, &random);
  const double squares =
      MeasurePlane(0, kPatch.Plane(), observations, kSquares).information;
  // The efficiency of estimates with Cauchy's loss, for scales of 0.5, 1, 20,
  // and 21, which counts as none.
  const double scales[] = {0.5, 1.0, 20.0, 21.0};
  const double expected[] = {1.0 / 1.888, 1.0 / 1.314, 1.0, 1.0};
  for (int i = 0; i < 4; ++i) {
    const MeasurePlaneOptions options = {scales[i], 0.0};
    EXPECT_NEAR(
        MeasurePlane(0, kPatch.Plane(), observations, options).information /
            squares,
        expected[i],
        0.03)
        << scales[i];
  }
}

TEST(MeasurePlane, NothingWhereNothingIsSeen) {
  EXPECT_TRUE(MeasurePlane(0, kPatch.Plane(), {}).form.isZero(0.0));
  auto observations = ObservePatch(kPatch, kCenter, 3);
  const WorldPlane through =
      PlaneThrough({1.0, 2.0, 3.0}, observations[0].center);
  EXPECT_EQ(MeasurePlane(0, through, observations).information, 0.0);
  EXPECT_TRUE(MeasurePlane(0, through, observations).form.isZero(0.0));
  for (DepthObservation& observation : observations) {
    observation.weight = 0.0;
  }
  EXPECT_EQ(MeasurePlane(0, kPatch.Plane(), observations).information, 0.0);
}

class MeasureViewTest : public testing::Test {
 protected:
  // What a view of the room measured of its surfaces, each superpixel on the
  // surface that it shows.
  std::vector<PlaneMeasurement> Measure(int view,
                                        const std::vector<int>& assignment) {
    std::vector<ModelPlane> planes;
    for (const DrawnSurface& surface : room_.surfaces) {
      planes.emplace_back().plane = surface.plane;
    }
    return MeasureView(room_.Views()[view], assignment, planes, 1.0);
  }

  SyntheticRoom room_;
};

TEST_F(MeasureViewTest, MeasuresThePlanesThatTheViewShows) {
  const std::vector<PlaneMeasurement> measurements = Measure(1, room_.seen[1]);
  ASSERT_EQ(measurements.size(), 3u);
  for (int p = 0; p < 3; ++p) {
    const PlaneMeasurement& measurement = measurements[p];
    const DrawnSurface& surface = room_.surfaces[p];
    EXPECT_EQ(measurement.plane, p);
    EXPECT_LT((measurement.center - room_.cameras[1].Center()).norm(), 1e-12);
    EXPECT_LT(std::abs(surface.plane.Height(measurement.foot)), 1e-9);
    EXPECT_LT((measurement.foot - surface.middle).norm(), 2.0);
    WorldPlane moved = surface.plane;
    moved.offset += 0.1;
    EXPECT_GT(Cost(measurement, moved), Cost(measurement, surface.plane) + 1.0);
  }
}

TEST_F(MeasureViewTest, SuperpixelsWithoutAPlaneTellNothing) {
  std::vector<int> assignment = room_.seen[0];
  for (int& plane : assignment) {
    plane = plane == 1 ? 1 : -1;
  }
  const std::vector<PlaneMeasurement> measurements = Measure(0, assignment);
  ASSERT_EQ(measurements.size(), 1u);
  EXPECT_EQ(measurements[0].plane, 1);
  EXPECT_EQ(measurements[0].form, Measure(0, room_.seen[0])[1].form);
  std::fill(assignment.begin(), assignment.end(), -1);
  EXPECT_TRUE(Measure(0, assignment).empty());
}

}  // namespace
}  // namespace tsar
