// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/point_sample.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

const Eigen::Vector3d kOrigin(1000.0, 2000.0, 3000.0);

// A camera at this place that looks along the x axis, in either direction, with
// y down.
Camera LookAlongX(const Eigen::Vector3d& center, bool forward) {
  Camera camera;
  camera.fx = camera.fy = 100.0;
  camera.cx = camera.cy = 99.5;
  camera.width = camera.height = 200;
  const double sign = forward ? 1.0 : -1.0;
  camera.rotation << 0.0, 0.0, -sign, 0.0, 1.0, 0.0, sign, 0.0, 0.0;
  camera.translation = -camera.rotation * (kOrigin + center);
  return camera;
}

// The walls x = 0 and x = 10 of a room, its floor y = 2 and its ceiling y = -2,
// and what no scene has, far away. The first wall was recorded closely: it has
// twice the points of all others.
PointSample MakeRoom() {
  PointSample points;
  const auto add = [&](double x, double y, double z) {
    points.Add({x, y, z}, {});
  };
  for (double z = -2.0; z <= 2.0; z += 0.1) {
    for (double x = 0.0; x <= 10.0; x += 0.1) {
      add(x, 2.0, z);
      add(x, -2.0, z);
    }
    for (double y = -2.0; y <= 2.0; y += 0.1) {
      add(10.0, y, z);
    }
  }
  const size_t num_points = points.NumPoints();
  for (size_t i = 0; i < 2 * num_points; ++i) {
    const double share =
        static_cast<double>(i) / static_cast<double>(2 * num_points);
    add(0.0, 4.0 * share - 2.0, static_cast<double>(i % 101) * 0.04 - 2.0);
  }
  add(1e5, 1e5, 1e5);
  return points;
}

TEST(Viewpoint, IsThatOfTheCameraThatSeesMostOfTheScene) {
  const Camera at_the_wall = LookAlongX({0.4, 0.0, 0.0}, false);
  const Camera behind_the_wall = LookAlongX({-1.0, 0.0, 0.0}, true);
  const Camera across = LookAlongX({9.0, 0.0, 0.0}, false);
  const PointSample room = MakeRoom();
  const std::optional<Viewpoint> chosen = ChooseViewpoint(
      {at_the_wall, behind_the_wall, across, at_the_wall}, room, kOrigin);
  ASSERT_TRUE(chosen);
  EXPECT_TRUE(chosen->eye.isApprox(Eigen::Vector3d(9.0, 0.0, 0.0), 1e-9))
      << chosen->eye.transpose();
  // On its axis, in the room.
  EXPECT_NEAR(chosen->target.y(), 0.0, 1e-9);
  EXPECT_NEAR(chosen->target.z(), 0.0, 1e-9);
  EXPECT_GT(chosen->target.x(), 0.0);
  EXPECT_LT(chosen->target.x(), 7.0);
}

TEST(Viewpoint, IsNoneWhereNoCameraSeesAPoint) {
  const Camera away = LookAlongX({11.0, 0.0, 0.0}, true);
  EXPECT_FALSE(ChooseViewpoint({away}, MakeRoom(), kOrigin));
  EXPECT_FALSE(ChooseViewpoint({away}, {}, kOrigin));
  EXPECT_FALSE(ChooseViewpoint({}, MakeRoom(), kOrigin));
}

TEST(Viewpoint, ASinglePointIsEnough) {
  PointSample point;
  point.Add({3.0, 0.0, 0.0}, {});
  const std::optional<Viewpoint> chosen =
      ChooseViewpoint({LookAlongX({0.0, 0.0, 0.0}, true)}, point, kOrigin);
  ASSERT_TRUE(chosen);
  EXPECT_TRUE(chosen->target.isApprox(Eigen::Vector3d(3.0, 0.0, 0.0), 1e-9));
}

}  // namespace
}  // namespace tsar
