// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/merge_planes.h"

#include <algorithm>
#include <cmath>

#include "tests/scene/discovery/discover_planes_fixture.h"
#include "tests/support/synthetic_room.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(DiscoverPlanesTest, KeepsAPosterApartFromItsWall) {
  const SyntheticRoom room({Poster()});
  ASSERT_GT(std::count(room.seen[0].begin(), room.seen[0].end(), kPoster), 5);
  const DiscoveredPlanes found = Discover(room);
  ExpectSurfaces(room, found);
  ExpectAssigned(room, found);
}

TEST_F(DiscoverPlanesTest, LeavesOutPlanesThatAreNotWorthTheirCost) {
  const SyntheticRoom room;
  std::vector<WorldPlane> candidates;
  for (const DrawnSurface& surface : room.surfaces) {
    candidates.push_back(surface.plane);
  }
  const std::vector<ScenePlane> all = Discover(room, candidates).planes;
  ASSERT_EQ(all.size(), 3u);
  ASSERT_GT(all[0].support, 1.5 * all[1].support);
  options_.min_gain = 0.5 * (all[0].support + all[1].support);
  const std::vector<ScenePlane> found = Discover(room, candidates).planes;
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(Find(room.surfaces[kWall], found), 0);
  options_.min_gain = 2.0 * all[0].support;
  EXPECT_TRUE(Discover(room, candidates).planes.empty());
}

TEST_F(DiscoverPlanesTest, MergesPlanesThatOneCanReplace) {
  // Two strips turned by opposite angles: neither's plane comes near the other
  // one, but a plane between them fits both nearly as well.
  const Eigen::Vector3d direction(0.0, 0.0, -1.0);
  const Eigen::Vector3d left(-1.5, 0.4, 3.5);
  const Eigen::Vector3d right(0.9, 0.4, 3.5);
  const SyntheticRoom room({Board({0.02, 0.0, -1.0}, left, 0.4),
                            Board({-0.02, 0.0, -1.0}, right, 0.4)});
  const std::vector<WorldPlane> candidates = {room.surfaces[3].plane,
                                              room.surfaces[4].plane};
  EXPECT_EQ(Discover(room, candidates).planes.size(), 2u);
  options_.min_gain = 500.0;
  const std::vector<ScenePlane> found = Discover(room, candidates).planes;
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(AngleBetween(found[0].plane, PlaneThrough(direction, left)), 0.15);
  EXPECT_NEAR(found[0].plane.Height(left), 0.0, 0.003);
  EXPECT_NEAR(found[0].plane.Height(right), 0.0, 0.003);
}

// Half of the wall's superpixels are measured 0.6 pixels of disparity too far.
class TwoDepthsOfAWallTest : public DiscoverPlanesTest {
 protected:
  static constexpr float kStep = 0.6f;

  // is_far(room, view, superpixel): of those on the wall.
  template <typename Function>
  DiscoveredPlanes DiscoverWhere(const Function& is_far) {
    SyntheticRoom room;
    WorldPlane far = room.surfaces[kWall].plane;
    far.offset += kStep * 5.0 * 5.0 * SyntheticRoom::kErrorPerDepth;
    std::vector<WorldPlane> candidates = room.Candidates();
    candidates.push_back(far);
    for (int view = 0; view < static_cast<int>(room.seen.size()); ++view) {
      for (int k = 0; k < SyntheticRoom::kNumSuperpixels; ++k) {
        if (room.seen[view][k] == kWall && is_far(room, view, k)) {
          room.MoveAway(view, k, kStep);
        }
      }
    }
    return Discover(room, candidates);
  }

  // Counts the planes that face as the wall does.
  static int CountWalls(const DiscoveredPlanes& found) {
    const WorldPlane wall = SyntheticRoom().surfaces[kWall].plane;
    return static_cast<int>(std::count_if(
        found.planes.begin(), found.planes.end(), [&](const auto& plane) {
          return AngleBetween(plane.plane, wall) < 2.0;
        }));
  }
};

TEST_F(TwoDepthsOfAWallTest, AreOnePlaneWhereViewsTakeThemForEachOther) {
  const DiscoveredPlanes found =
      DiscoverWhere([](const SyntheticRoom&, int view, int superpixel) {
        return (superpixel + view) % 2 == 0;
      });
  EXPECT_EQ(CountWalls(found), 1);
}

TEST_F(TwoDepthsOfAWallTest, AreTwoPlanesWhereAllViewsSeeThemInTheirPlaces) {
  const DiscoveredPlanes found = DiscoverWhere([](const SyntheticRoom& room,
                                                  int view,
                                                  int superpixel) {
    const ViewEvidence& evidence = room.evidence[view];
    const RayDepth& sample =
        evidence.observations[evidence.first_observation[superpixel]].sample;
    const Eigen::Vector3d point =
        room.cameras[view].Center() +
        room.cameras[view].rotation.transpose() *
            (sample.z * Eigen::Vector3d(sample.x, sample.y, 1.0));
    return std::abs(point.x() + 0.5) < 0.8;
  });
  EXPECT_EQ(CountWalls(found), 2);
}

// Two boards side by side, one slightly in front of the other, and the plane
// between them, which explains more than either one's.
class TwoBoardsTest : public DiscoverPlanesTest {
 protected:
  static constexpr double kStep = 0.0145;  // 1.2 expected errors.

  void ExpectBoards(const DiscoveredPlanes& found) const {
    ASSERT_EQ(found.planes.size(), 2u);
    // The larger one first.
    EXPECT_EQ(Find(room_.surfaces[4], found.planes), 0);
    EXPECT_EQ(Find(room_.surfaces[3], found.planes), 1);
    EXPECT_LT(found.planes[1].support, 0.95 * found.planes[0].support);
  }

  const SyntheticRoom room_{
      {Board({0.0, 0.0, -1.0}, {-1.2, 0.4, 3.5}, 0.6),
       Board({0.0, 0.0, -1.0}, {0.1, 0.4, 3.5 + kStep}, 0.7)}};
  const WorldPlane first_ = room_.surfaces[3].plane;
  const WorldPlane second_ = room_.surfaces[4].plane;
  const WorldPlane between_ = {first_.normal,
                               0.5 * (first_.offset + second_.offset)};
};

TEST_F(TwoBoardsTest, DropsAPlaneThatLaterOnesReplace) {
  options_.max_planes = 1;
  const std::vector<ScenePlane> one =
      Discover(room_, {first_, second_, between_}).planes;
  ASSERT_EQ(one.size(), 1u);
  ASSERT_EQ(Find(room_.surfaces[3], one), -1);
  ASSERT_EQ(Find(room_.surfaces[4], one), -1);
  options_.max_planes = 3;
  ExpectBoards(Discover(room_, {first_, second_, between_}));
}

TEST_F(TwoBoardsTest, FitsAPlaneToWhatIsLeftToIt) {
  ExpectBoards(Discover(room_, {between_, second_}));
}

// The room and a board that leans towards its floor.
class LeaningBoardTest : public DiscoverPlanesTest {
 protected:
  static SyntheticRoom RoomWithBoard(double degrees) {
    const Eigen::Vector3d wall = SyntheticRoom().surfaces[kWall].plane.normal;
    return SyntheticRoom({Board(
        wall + std::tan(degrees * M_PI / 180.0) * Eigen::Vector3d::UnitY(),
        {-0.2, 0.4, 3.5},
        0.9)});
  }

  WorldPlane FindBoard(const SyntheticRoom& room, bool regular) {
    options_.manhattan_frame = regular;
    const DiscoveredPlanes found = Discover(room);
    EXPECT_EQ(found.planes.size(), 4u);
    for (const ScenePlane& plane : found.planes) {
      if (AngleBetween(plane.plane, room.surfaces[kBoard].plane) < 1.0 &&
          std::abs(plane.plane.Height(room.surfaces[kBoard].middle)) < 0.003) {
        return plane.plane;
      }
    }
    ADD_FAILURE() << "no board";
    return {};
  }

  static constexpr int kBoard = 3;
};

TEST_F(LeaningBoardTest, BecomesOrthogonalWhereItLeansByLittle) {
  const SyntheticRoom room = RoomWithBoard(0.4);
  const WorldPlane leaning = FindBoard(room, false);
  EXPECT_LT(AngleBetween(leaning, room.surfaces[kBoard].plane), 0.15);
  FindBoard(room, true);
  const DiscoveredPlanes found = Discover(room);
  ASSERT_EQ(found.planes.size(), 4u);
  for (const ScenePlane& a : found.planes) {
    for (const ScenePlane& b : found.planes) {
      const double cosine = std::abs(a.plane.normal.dot(b.plane.normal));
      EXPECT_LT(std::min(cosine, std::abs(1.0 - cosine)), 1e-9);
    }
  }
  ASSERT_TRUE(found.frame);
  for (const ScenePlane& plane : found.planes) {
    ASSERT_GE(plane.axis, 0);
    EXPECT_NEAR(std::abs(found.frame->col(plane.axis).dot(plane.plane.normal)),
                1.0,
                1e-12);
  }
}

TEST_F(LeaningBoardTest, StaysOutOfTheFrameWhereItLeansByMuch) {
  const SyntheticRoom room = RoomWithBoard(3.0);
  const DiscoveredPlanes found = Discover(room);
  ASSERT_TRUE(found.frame);
  for (const ScenePlane& plane : found.planes) {
    const bool is_board =
        AngleBetween(plane.plane, room.surfaces[kBoard].plane) < 1.0 &&
        std::abs(plane.plane.Height(room.surfaces[kBoard].middle)) < 0.003;
    EXPECT_EQ(plane.axis < 0, is_board);
  }
  const WorldPlane board = FindBoard(room, true);
  EXPECT_LT(AngleBetween(FindBoard(room, false), board), 0.15);
  EXPECT_FALSE(Discover(room).frame);
}

}  // namespace
}  // namespace tsar
