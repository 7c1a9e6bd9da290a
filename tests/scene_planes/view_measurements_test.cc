// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/view_measurements.h"

#include "tests/support/synthetic_room.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

class MeasureViewTest : public testing::Test {
 protected:
  // What a view of the room measured of its surfaces, each superpixel on the
  // surface that it shows.
  std::vector<PlaneMeasurement> Measure(int view,
                                        const std::vector<int>& assignment) {
    std::vector<WorldPlane> planes;
    for (const DrawnSurface& surface : room_.surfaces) {
      planes.push_back(surface.plane);
    }
    return MeasureView(
        room_.Views()[static_cast<size_t>(view)], assignment, planes, options_);
  }

  // The error of the form's best inverse depth at the plane, in its expected
  // errors, squared.
  static double Cost(const PlaneMeasurement& measurement,
                     const WorldPlane& plane) {
    Eigen::Vector4d q;
    q << plane.normal / plane.Height(measurement.center), 1.0;
    return q.dot(measurement.form * q);
  }

  SyntheticRoom room_;
  MeasureViewOptions options_;
};

TEST_F(MeasureViewTest, MeasuresThePlanesThatTheViewShows) {
  const std::vector<PlaneMeasurement> measurements = Measure(1, room_.seen[1]);
  ASSERT_EQ(measurements.size(), 3u);
  for (int p = 0; p < 3; ++p) {
    const PlaneMeasurement& measurement = measurements[static_cast<size_t>(p)];
    const DrawnSurface& surface = room_.surfaces[static_cast<size_t>(p)];
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

TEST_F(MeasureViewTest, ErrorsThatGoTogetherLimitWhatOneViewTells) {
  options_.planes.common_deviation = 0.0;
  const double alone = Measure(0, room_.seen[0])[0].information;
  options_.planes.common_deviation = 0.5;
  const double together = Measure(0, room_.seen[0])[0].information;
  EXPECT_LT(together, 0.3 * alone);
  options_.error_share = 0.5;
  options_.planes.common_deviation = 0.0;
  // Half as exact, and further inside of the loss.
  EXPECT_LT(Measure(0, room_.seen[0])[0].information, 0.3 * alone);
}

}  // namespace
}  // namespace tsar
