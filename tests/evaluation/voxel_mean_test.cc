// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/evaluation/laser_scan.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr PointVerdict kGood{0, true};
constexpr PointVerdict kBad{1, true};
constexpr PointVerdict kUncounted{1, false};

TEST(VoxelMeans, WeighVoxelsAlikeHoweverManyPointsTheyHold) {
  const std::vector<Eigen::Vector3d> points = {
      {0.3, 0.3, 0.3}, {-9.7, 0.3, 0.3}, {-9.7, 0.3, 0.3}, {-9.7, 0.3, 0.3}};
  EXPECT_EQ(VoxelMeans(points, {kGood, kBad, kBad, kBad}, 1, 1.0),
            std::vector<double>{0.5});
}

TEST(VoxelMeans, TakeTheShareWithinAVoxel) {
  const std::vector<Eigen::Vector3d> points(4, {0.3, 0.3, 0.3});
  EXPECT_EQ(VoxelMeans(points, {kGood, kBad, kBad, kBad}, 1, 1.0),
            std::vector<double>{0.25});
}

TEST(VoxelMeans, AverageTwoGridsShiftedByHalfAVoxel) {
  // One voxel in the first grid, two in the shifted one: (0.5 + 1 + 0) / 3.
  const std::vector<Eigen::Vector3d> points = {{0.2, 0.1, 0.1},
                                               {0.8, 0.1, 0.1}};
  EXPECT_EQ(VoxelMeans(points, {kGood, kBad}, 1, 1.0),
            std::vector<double>{0.5});
  EXPECT_DOUBLE_EQ(
      VoxelMeans({{0.2, 0.1, 0.1}, {0.2, 0.1, 0.1}, {0.8, 0.1, 0.1}},
                 {kGood, kGood, kBad},
                 1,
                 1.0)[0],
      (2.0 / 3 + 1 + 0) / 3);
}

TEST(VoxelMeans, LeaveOutWhatIsNotCounted) {
  const std::vector<Eigen::Vector3d> points = {
      {0.3, 0.3, 0.3}, {0.3, 0.3, 0.3}, {9.3, 0.3, 0.3}};
  EXPECT_EQ(VoxelMeans(points, {kGood, kUncounted, kUncounted}, 1, 1.0),
            std::vector<double>{1.0});
  EXPECT_EQ(VoxelMeans({{0, 0, 0}}, {kUncounted}, 1, 1.0),
            std::vector<double>{0.0});
  EXPECT_EQ(VoxelMeans({}, {}, 2, 1.0), (std::vector<double>{0.0, 0.0}));
}

TEST(VoxelMeans, FollowTheTolerances) {
  EXPECT_EQ(VoxelMeans({{0, 0, 0}}, {{1, true}}, 3, 1.0),
            (std::vector<double>{0.0, 1.0, 1.0}));
}

TEST(VoxelMeans, StandPointsOfAnySize) {
  EXPECT_EQ(VoxelMeans({{1e300, -1e300, 0}, {0, 0, 0}}, {kGood, kBad}, 1, 0.01),
            std::vector<double>{0.5});
}

}  // namespace
}  // namespace tsar
