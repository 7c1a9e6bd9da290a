// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/axis_camera.h"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

namespace tsar {
namespace {

// Heights are along -y, as cameras look with y down.
const AxisFrame kUpright = {-Eigen::Vector3d::UnitY(),
                            Eigen::Vector3d::UnitX()};

// Looks along z, pitched by an angle.
Camera MakeCamera(double pitch = 0.0) {
  Camera camera;
  camera.width = 240;
  camera.height = 180;
  camera.fx = camera.fy = 220.0;
  camera.cx = 119.5;
  camera.cy = 89.5;
  camera.rotation =
      Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()).toRotationMatrix();
  camera.translation = camera.rotation * Eigen::Vector3d(-0.3, 0.4, -0.5);
  return camera;
}

// The ray of the view that looks at a point in the world.
Eigen::Vector3d RayOf(const Camera& camera, const Eigen::Vector3d& point) {
  return camera.rotation * point + camera.translation;
}

TEST(AxisCameraTest, ColumnsAreParallelToTheAxis) {
  for (const double pitch : {-0.4, 0.0, 0.4}) {
    SCOPED_TRACE(pitch);
    const Camera camera = MakeCamera(pitch);
    const std::optional<AxisCamera> rectified =
        MakeAxisCamera(camera, kUpright);
    ASSERT_TRUE(rectified);
    double column = 0.0;
    for (const double height : {-0.5, 0.1, 0.6}) {
      const Eigen::Vector3d point(0.7, -height, 4.0);
      const Eigen::Vector3d ray =
          rectified->to_view.transpose() * RayOf(camera, point);
      const double seen_column =
          rectified->cx + rectified->focal * ray.x() / ray.z();
      const double row = rectified->cy + rectified->focal * ray.y() / ray.z();
      if (height > -0.5) {
        EXPECT_NEAR(seen_column, column, 1e-9);
      }
      column = seen_column;
      EXPECT_NEAR(rectified->Height(row, ray.z()), height, 1e-9);
    }
    // Its direction passes through the point.
    const Eigen::Vector2d to_point =
        kUpright.Across({0.7, 0.0, 4.0}) - rectified->center;
    const Eigen::Vector2d direction = rectified->Direction(column);
    EXPECT_NEAR(
        to_point.x() * direction.y() - to_point.y() * direction.x(), 0.0, 1e-9);
    EXPECT_GT(to_point.dot(direction), 0.0);
  }
}

TEST(AxisCameraTest, HoldsTheWholeImage) {
  const Camera camera = MakeCamera(0.3);
  const std::optional<AxisCamera> rectified = MakeAxisCamera(camera, kUpright);
  ASSERT_TRUE(rectified);
  for (const double x : {0.0, 239.0}) {
    for (const double y : {0.0, 179.0}) {
      const Eigen::Vector3d ray =
          rectified->to_view.transpose() *
          Eigen::Vector3d(
              (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
      const double column =
          rectified->cx + rectified->focal * ray.x() / ray.z();
      const double row = rectified->cy + rectified->focal * ray.y() / ray.z();
      EXPECT_GE(column, -1e-9);
      EXPECT_LE(column, rectified->width);
      EXPECT_GE(row, -1e-9);
      EXPECT_LE(row, rectified->height);
    }
  }
}

TEST(AxisCameraTest, NeedsAnAxisAcrossTheView) {
  EXPECT_TRUE(MakeAxisCamera(MakeCamera(0.8), kUpright));
  EXPECT_FALSE(MakeAxisCamera(MakeCamera(1.0), kUpright));
  EXPECT_FALSE(MakeAxisCamera(
      MakeCamera(), {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX()}));
}

// Pixels that are not square become so, without more of them than there are.
TEST(AxisCameraTest, TakesTheShorterFocalLength) {
  for (const bool is_x : {true, false}) {
    Camera camera = MakeCamera();
    (is_x ? camera.fx : camera.fy) *= 3.0;
    const std::optional<AxisCamera> rectified =
        MakeAxisCamera(camera, kUpright);
    ASSERT_TRUE(rectified);
    EXPECT_EQ(rectified->focal, 220.0);
    EXPECT_NEAR(rectified->width, is_x ? 80 : 240, 1);
    EXPECT_NEAR(rectified->height, is_x ? 180 : 60, 1);
  }
}

TEST(AxisCameraTest, IsNeverMuchLargerThanTheRaster) {
  for (const double fx : {1e-300, 1e-9, 1e-3, 1.0, 1e3, 1e9, 1e12, 1e300}) {
    for (const double fy : {1e-300, 1e-9, 1e-3, 1.0, 1e3, 1e9, 1e12, 1e300}) {
      Camera camera = MakeCamera(0.3);
      camera.fx = fx;
      camera.fy = fy;
      if (const std::optional<AxisCamera> rectified =
              MakeAxisCamera(camera, kUpright)) {
        EXPECT_GE(rectified->width, 1) << fx << " " << fy;
        EXPECT_GE(rectified->height, 1) << fx << " " << fy;
        EXPECT_LE(rectified->width, 4 * (240 + 180) + 1) << fx << " " << fy;
        EXPECT_LE(rectified->height, 4 * (240 + 180) + 1) << fx << " " << fy;
      }
    }
  }
  // Of one column by a thousand million rows.
  Camera camera = MakeCamera();
  camera.fx = 1e9;
  const std::optional<AxisCamera> rectified = MakeAxisCamera(camera, kUpright);
  ASSERT_TRUE(rectified);
  EXPECT_EQ(rectified->width, 1);
  EXPECT_NEAR(rectified->height, 180, 1);
}

// A principal point far outside the image, and what is no number.
TEST(AxisCameraTest, TakesNothingFromCamerasThatCannotBe) {
  for (const double wrong : {1e9, 1e300, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    Camera camera = MakeCamera();
    camera.cx = wrong;
    EXPECT_FALSE(MakeAxisCamera(camera, kUpright)) << wrong;
  }
  Camera camera = MakeCamera();
  camera.fy = NAN;
  EXPECT_FALSE(MakeAxisCamera(camera, kUpright));
  camera = MakeCamera();
  camera.rotation.setConstant(NAN);
  EXPECT_FALSE(MakeAxisCamera(camera, kUpright));
  EXPECT_FALSE(MakeAxisCamera(
      MakeCamera(), {Eigen::Vector3d::Constant(NAN), Eigen::Vector3d::Zero()}));
}

}  // namespace
}  // namespace tsar
