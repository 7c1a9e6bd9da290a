// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/exported_planes.h"

#include <cmath>

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

TEST(FindVertical, TakesTheAxisNearTheCameras) {
  const Vertical vertical = FindVertical({kUp, Turn(30) * kUp}, {Turn(10)});
  EXPECT_EQ(vertical.source, Vertical::Source::kFrame);
  EXPECT_NEAR((vertical.up - Turn(10) * kUp).norm(), 0.0, 1e-12);
  // Also where it points down.
  const Vertical turned = FindVertical({kUp}, {Turn(180)});
  EXPECT_NEAR((turned.up - kUp).norm(), 0.0, 1e-12);
  EXPECT_EQ(ToString(turned.source), "manhattan_frame");
}

TEST(FindVertical, TakesTheNearestOfSeveralFrames) {
  const Vertical vertical = FindVertical({kUp}, {Turn(10), Turn(5), Turn(20)});
  EXPECT_NEAR((vertical.up - Turn(5) * kUp).norm(), 0.0, 1e-12);
}

TEST(FindVertical, TakesTheCamerasWhereNoAxisIsNear) {
  for (const std::vector<Eigen::Matrix3d>& frames :
       {std::vector<Eigen::Matrix3d>(), {Turn(45)}}) {
    const Vertical vertical =
        FindVertical({Turn(-8) * kUp, Turn(8) * kUp}, frames);
    EXPECT_EQ(vertical.source, Vertical::Source::kCameras);
    EXPECT_NEAR((vertical.up - kUp).norm(), 0.0, 1e-12);
  }
  EXPECT_EQ(ToString(Vertical::Source::kCameras), "cameras");
}

TEST(FindVertical, KnowsWhenNothingIsKnown) {
  for (const std::vector<Eigen::Vector3d>& ups :
       {std::vector<Eigen::Vector3d>(), {kUp, -kUp}}) {
    const Vertical vertical = FindVertical(ups, {Turn(0)});
    EXPECT_EQ(vertical.source, Vertical::Source::kNone);
    EXPECT_EQ(ClassifyPlane(kUp, {0, 0, 0}, {{0, 0, 1}}, vertical),
              PlaneClass::kOther);
  }
  EXPECT_EQ(ToString(Vertical::Source::kNone), "none");
}

TEST(ClassifyPlane, GoesByDirectionAndCameras) {
  const Vertical vertical = {kUp, Vertical::Source::kCameras};
  const auto classify = [&](double degrees, double camera) {
    // Either direction of a normal stands for the same plane.
    const Eigen::Vector3d normal = Turn(degrees) * kUp;
    const Eigen::Vector3d point(1, 0, 0);
    const std::vector<Eigen::Vector3d> cameras = {
        {1, 0, camera}, {1, 0, camera}, {1, 0, -camera}};
    const PlaneClass of_plane = ClassifyPlane(normal, point, cameras, vertical);
    EXPECT_EQ(ClassifyPlane(-normal, point, cameras, vertical), of_plane);
    return ToString(of_plane);
  };
  EXPECT_EQ(classify(0, 1), "floor");
  EXPECT_EQ(classify(14, 1), "floor");
  EXPECT_EQ(classify(14, -1), "ceiling");
  EXPECT_EQ(classify(16, 1), "other");
  EXPECT_EQ(classify(74, 1), "other");
  EXPECT_EQ(classify(76, 1), "wall");
  EXPECT_EQ(classify(104, -1), "wall");
}

}  // namespace
}  // namespace tsar
