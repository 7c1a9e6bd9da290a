// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/manhattan_frame.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tsar {
namespace {

Eigen::Matrix3d Turned(double degrees) {
  return Eigen::AngleAxisd(degrees * M_PI / 180.0,
                           Eigen::Vector3d(1.0, 2.0, 3.0).normalized())
      .toRotationMatrix();
}

// Its columns in another order.
Eigen::Matrix3d Permuted(const Eigen::Matrix3d& frame) {
  Eigen::Matrix3d result;
  result << -frame.col(1), frame.col(2), -frame.col(0);
  return result;
}

std::vector<ModelPlane> PlanesAlong(const Eigen::Matrix3d& frame) {
  std::vector<ModelPlane> planes(3);
  for (int i = 0; i < 3; ++i) {
    planes[i].plane.normal = frame.col(i);
  }
  return planes;
}

// A block of views with planes of these axes and supports.
PlaneBlock Block(int component,
                 const std::optional<Eigen::Matrix3d>& frame,
                 const std::vector<std::pair<int, double>>& planes) {
  PlaneBlock block;
  block.component = component;
  block.frame = frame;
  for (const auto& [axis, support] : planes) {
    block.planes.push_back({{{}, support, axis}, {}});
  }
  return block;
}

TEST(FindSceneFramesTest, OneFrameIsKeptWithItsPlanes) {
  std::vector<ModelPlane> planes = PlanesAlong(Turned(20.0));
  const std::vector<Eigen::Matrix3d> frames =
      FindSceneFrames({Block(0, Turned(20.0), {{2, 5.0}, {-1, 5.0}, {0, 5.0}})},
                      {{2, 1, 0}},
                      &planes);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0], Turned(20.0));
  EXPECT_EQ(planes[0].axis, 0);
  EXPECT_EQ(planes[0].frame, 0);
  EXPECT_EQ(planes[1].axis, -1);
  EXPECT_EQ(planes[1].frame, -1);
  EXPECT_EQ(planes[2].axis, 2);
}

TEST(FindSceneFramesTest, FramesOfBlocksBecomeOneWhateverTheirColumns) {
  std::vector<ModelPlane> planes = PlanesAlong(Turned(20.0));
  const std::vector<Eigen::Matrix3d> frames =
      FindSceneFrames({Block(0, Permuted(Turned(21.0)), {{2, 1.0}, {0, 1.0}}),
                       Block(0, Turned(20.0), {{2, 9.0}})},
                      {{0, 1}, {2}},
                      &planes);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0], Turned(20.0));  // Its block measured most.
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(planes[i].frame, 0);
    EXPECT_EQ(planes[i].axis, i);
  }
}

TEST(FindSceneFramesTest, FramesThatDifferOrShareNoViewsStayApart) {
  for (const int component : {0, 1}) {
    std::vector<ModelPlane> planes = PlanesAlong(Turned(0.0));
    planes[1].plane.normal = Turned(component == 0 ? 5.0 : 1.0).col(1);
    const std::vector<Eigen::Matrix3d> frames = FindSceneFrames(
        {Block(0, Turned(0.0), {{0, 9.0}}),
         Block(component, Turned(component == 0 ? 5.0 : 1.0), {{1, 8.0}})},
        {{0}, {1}},
        &planes);
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(planes[0].frame, 0);
    EXPECT_EQ(planes[1].frame, 1);
    EXPECT_EQ(planes[1].axis, 1);
  }
}

TEST(FindSceneFramesTest, MostOfWhatWasMeasuredDecides) {
  std::vector<ModelPlane> planes = PlanesAlong(Turned(0.0));
  // One part of the first plane was aligned and one, which measured more, was
  // not; the second plane has left its axis since; so nothing has a frame.
  planes[1].plane.normal = Turned(4.0).col(1);
  const std::vector<Eigen::Matrix3d> frames =
      FindSceneFrames({Block(0, Turned(0.0), {{0, 2.0}, {1, 9.0}}),
                       Block(0, std::nullopt, {{-1, 3.0}})},
                      {{0, 1}, {0}},
                      &planes);
  EXPECT_TRUE(frames.empty());
  EXPECT_EQ(planes[0].axis, -1);
  EXPECT_EQ(planes[1].axis, -1);
}

}  // namespace
}  // namespace tsar
