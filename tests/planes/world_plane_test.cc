// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/planes/world_plane.h"

#include "tests/support/synthetic_observations.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

class WorldPlaneTest : public testing::Test {
 protected:
  const Camera camera_ = CameraLookingAt({1.0, -2.0, 0.5}, {0.5, 0.3, 4.0});
  const WorldPlane plane_ = PlaneThrough({0.3, -0.2, -1.0}, {0.0, 0.0, 4.0});
};

TEST_F(WorldPlaneTest, HeightIsTheDistanceOnTheSideOfTheNormal) {
  const WorldPlane plane = PlaneThrough({0.0, 0.0, -2.0}, {5.0, 6.0, 4.0});
  EXPECT_DOUBLE_EQ(plane.Height({-1.0, 9.0, 4.0}), 0.0);
  EXPECT_DOUBLE_EQ(plane.Height({0.0, 0.0, 1.0}), 3.0);
  EXPECT_DOUBLE_EQ(plane.Height({7.0, 0.0, 6.0}), -2.0);
}

TEST_F(WorldPlaneTest, ComesBackFromTheCameraFrame) {
  const WorldPlane back = ToWorldPlane(ToCameraPlane(plane_, camera_), camera_);
  EXPECT_LT(AngleBetween(back, plane_), 1e-5);
  EXPECT_NEAR(back.normal.norm(), 1.0, 1e-12);
  // It faces the camera, as the drawn one does.
  EXPECT_NEAR(back.offset, plane_.offset, 1e-6);
}

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

TEST_F(WorldPlaneTest, IsInvalidInACameraWithinIt) {
  EXPECT_FALSE(
      ToCameraPlane(PlaneThrough({0.0, 1.0, 0.0}, {3.0, 0.0, 1.0}), Camera())
          .Valid());
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
