// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/export_planes.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tsar {
namespace {

const Eigen::Vector3d kUp(0, 0, 1);

Eigen::Matrix3d Turn(double degrees) {
  return Eigen::AngleAxisd(degrees * 0.017453292519943295,
                           Eigen::Vector3d::UnitX())
      .toRotationMatrix();
}

TEST(FindVertical, TakesTheNearestAxisOrTheCameras) {
  using Source = Vertical::Source;
  struct Case {
    std::vector<Eigen::Vector3d> camera_ups;
    std::vector<Eigen::Matrix3d> frames;
    Source source;
    Eigen::Vector3d up;
  };
  const Case cases[] = {
      {{kUp, Turn(30) * kUp}, {Turn(10)}, Source::kFrame, Turn(10) * kUp},
      // An axis that points down.
      {{kUp}, {Turn(180)}, Source::kFrame, kUp},
      {{kUp}, {Turn(10), Turn(5), Turn(20)}, Source::kFrame, Turn(5) * kUp},
      {{Turn(-8) * kUp, Turn(8) * kUp}, {}, Source::kCameras, kUp},
      {{Turn(-8) * kUp, Turn(8) * kUp}, {Turn(45)}, Source::kCameras, kUp},
      {{}, {Turn(0)}, Source::kNone, {0, 0, 0}},
      {{kUp, -kUp}, {Turn(0)}, Source::kNone, {0, 0, 0}},
  };
  for (const Case& of : cases) {
    SCOPED_TRACE(&of - cases);
    const Vertical vertical = FindVertical(of.camera_ups, of.frames);
    EXPECT_EQ(vertical.source, of.source);
    EXPECT_NEAR((vertical.up - of.up).norm(), 0.0, 1e-12);
  }
}

TEST(ClassifyPlane, GoesByDirectionAndCameras) {
  struct Case {
    double degrees;
    double camera;  // The height of most cameras above the plane.
    PlaneClass expected;
  };
  const Case cases[] = {{0, 1, PlaneClass::kFloor},
                        {14, 1, PlaneClass::kFloor},
                        {14, -1, PlaneClass::kCeiling},
                        {16, 1, PlaneClass::kOther},
                        {74, 1, PlaneClass::kOther},
                        {76, 1, PlaneClass::kWall},
                        {104, -1, PlaneClass::kWall}};
  for (const auto& [degrees, camera, expected] : cases) {
    const Eigen::Vector3d normal = Turn(degrees) * kUp;
    const Eigen::Vector3d point(1, 0, 0);
    const std::vector<Eigen::Vector3d> cameras = {
        {1, 0, camera}, {1, 0, camera}, {1, 0, -camera}};
    const Vertical vertical = {kUp, Vertical::Source::kCameras};
    // Either direction of a normal stands for the same plane.
    EXPECT_EQ(ClassifyPlane(normal, point, cameras, vertical), expected);
    EXPECT_EQ(ClassifyPlane(-normal, point, cameras, vertical), expected);
    EXPECT_EQ(ClassifyPlane(normal, point, cameras, {}), PlaneClass::kOther);
  }
}

}  // namespace
}  // namespace tsar
