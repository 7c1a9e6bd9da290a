// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/discover_planes.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/support/drawn_room.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWall = 0;
constexpr int kLeft = 1;
constexpr int kFloor = 2;
constexpr int kPoster = 3;

// Of this width to either side of its middle.
DrawnSurface Board(const Eigen::Vector3d& direction,
                   const Eigen::Vector3d& middle,
                   double half_width) {
  return {PlaneThrough(direction, middle),
          middle,
          [middle, half_width](const Eigen::Vector3d& point) {
            return std::abs(point.x() - middle.x()) < half_width &&
                   std::abs(point.y() - middle.y()) < 0.8;
          }};
}

// Three expected errors before the back wall.
DrawnSurface Poster() {
  const DrawnSurface wall = DrawnRoom().surfaces[kWall];
  return Board(wall.plane.normal, wall.middle + 0.075 * wall.plane.normal, 1.0);
}

class DiscoverPlanesTest : public testing::Test {
 protected:
  DiscoveredPlanes Discover(const DrawnRoom& room) {
    return Discover(room, room.Candidates());
  }
  DiscoveredPlanes Discover(const DrawnRoom& room,
                            const std::vector<WorldPlane>& candidates) {
    return DiscoverPlanes(room.Views(), candidates, options_, *device_);
  }

  std::unique_ptr<Device> device_ = Device::CreateCpu(1);
  DiscoverPlanesOptions options_;
};

// The number of the found plane that is a surface's; -1 where there is none.
// unit: of length in the room.
int Find(const DrawnSurface& surface,
         const std::vector<ScenePlane>& found,
         double unit = 1.0) {
  for (size_t i = 0; i < found.size(); ++i) {
    if (AngleBetween(found[i].plane, surface.plane) < 0.15 &&
        std::abs(found[i].plane.Height(surface.middle)) < 0.003 * unit) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

void ExpectSurfaces(const DrawnRoom& room,
                    const DiscoveredPlanes& found,
                    double unit = 1.0) {
  EXPECT_EQ(found.planes.size(), room.surfaces.size());
  for (size_t i = 0; i < room.surfaces.size(); ++i) {
    EXPECT_GE(Find(room.surfaces[i], found.planes, unit), 0) << "surface " << i;
  }
}

// Every superpixel on one surface is served by that surface's plane.
void ExpectServed(const DrawnRoom& room, const DiscoveredPlanes& found) {
  ASSERT_EQ(found.serving.size(), room.seen.size());
  for (size_t view = 0; view < room.seen.size(); ++view) {
    ASSERT_EQ(found.serving[view].size(), room.seen[view].size());
    for (size_t k = 0; k < room.seen[view].size(); ++k) {
      if (room.seen[view][k] >= 0) {
        EXPECT_EQ(found.serving[view][k],
                  Find(room.surfaces[room.seen[view][k]], found.planes))
            << "view " << view << ", superpixel " << k;
      }
    }
  }
}

// What a found plane's support is by the header, where each mass is above the
// maximum.
double SupportOf(int plane,
                 const DiscoveredPlanes& found,
                 const std::vector<ObservedView>& views,
                 double max_mass) {
  double support = 0.0;
  for (size_t view = 0; view < views.size(); ++view) {
    const ViewEvidence& evidence = *views[view].evidence;
    const Camera& camera = views[view].camera;
    for (int k = 0; k < evidence.NumSuperpixels(); ++k) {
      if (found.serving[view][k] != plane) {
        continue;
      }
      double scores = 0.0;
      double qualities = 0.0;
      for (int i = evidence.first_observation[k];
           i < evidence.first_observation[k + 1];
           ++i) {
        const auto& [sample, quality] = evidence.observations[i];
        DepthObservation observation;
        observation.center = camera.Center();
        observation.ray = camera.rotation.transpose() *
                          Eigen::Vector3d(sample.x, sample.y, 1.0);
        observation.depth = sample.z;
        observation.sigma =
            sample.z * evidence.resolution.RelativeDepthError(sample.z);
        const double residual =
            NormalizedResidual(found.planes[plane].plane, observation);
        scores += quality * std::max(1.0 - residual * residual, 0.0);
        qualities += quality;
      }
      support += max_mass * scores / qualities;
    }
  }
  return support;
}

void ExpectSameBits(const DiscoveredPlanes& a, const DiscoveredPlanes& b) {
  ASSERT_EQ(a.planes.size(), b.planes.size());
  for (size_t i = 0; i < a.planes.size(); ++i) {
    EXPECT_EQ(a.planes[i].plane.normal, b.planes[i].plane.normal);
    EXPECT_EQ(a.planes[i].plane.offset, b.planes[i].plane.offset);
    EXPECT_EQ(a.planes[i].support, b.planes[i].support);
  }
  EXPECT_EQ(a.serving, b.serving);
}

TEST_F(DiscoverPlanesTest, FindsThePlanesOfARoomFromTiltedDuplicates) {
  const DrawnRoom room;
  ExpectSurfaces(room, Discover(room));
}

TEST_F(DiscoverPlanesTest, ServesEachSuperpixelByItsPlane) {
  const DrawnRoom room;
  int num_on_surface[3] = {};
  for (const std::vector<int>& of_view : room.seen) {
    for (const int surface : of_view) {
      if (surface >= 0) {
        ++num_on_surface[surface];
      }
    }
  }
  ASSERT_GT(*std::min_element(num_on_surface, num_on_surface + 3), 30);
  ExpectServed(room, Discover(room));
}

TEST_F(DiscoverPlanesTest, SupportIsTheSumOfTheScores) {
  const DrawnRoom room;
  const DiscoveredPlanes found = Discover(room);
  ASSERT_EQ(found.planes.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const double support = SupportOf(i, found, room.Views(), options_.max_mass);
    EXPECT_NEAR(found.planes[i].support, support, 1e-4 * support);
  }
}

TEST_F(DiscoverPlanesTest, BoundsTheSlopeOfGrazingRays) {
  // A floor just under the camera; all rays are at less than 3 degrees to it.
  const WorldPlane floor = PlaneThrough({0.0, -1.0, 0.0}, {0.0, 0.1, 0.0});
  constexpr int kNumSuperpixels = 20;
  ViewEvidence evidence;
  evidence.resolution.error_per_depth = DrawnRoom::kErrorPerDepth;
  evidence.mass.assign(kNumSuperpixels, 100.f);
  evidence.first_observation.push_back(0);
  Philox random(5, 0, 0);
  for (int k = 0; k < kNumSuperpixels; ++k) {
    for (int i = 0; i < 10; ++i) {
      const float y = 0.015f + 0.025f * random.NextFloat();
      const float z = 0.1f / y;
      const double error =
          0.6 * evidence.resolution.RelativeDepthError(z) * NextNormal(&random);
      evidence.observations.push_back(
          {{0.1f * k - 1.f, y, z * static_cast<float>(1.0 + error)}, 1.f});
    }
    evidence.first_observation.push_back(10 * (k + 1));
  }
  const std::vector<ObservedView> views = {{&evidence, Camera()}};
  const DiscoveredPlanes found =
      DiscoverPlanes(views, {floor}, options_, *device_);
  ASSERT_EQ(found.planes.size(), 1u);
  EXPECT_LT(AngleBetween(found.planes[0].plane, floor), 0.1);
  const double support = SupportOf(0, found, views, options_.max_mass);
  EXPECT_NEAR(found.planes[0].support, support, 1e-4 * support);
}

TEST_F(DiscoverPlanesTest, KeepsAPosterApartFromItsWall) {
  const DrawnRoom room({Poster()});
  ASSERT_GT(std::count(room.seen[0].begin(), room.seen[0].end(), kPoster), 5);
  const DiscoveredPlanes found = Discover(room);
  ExpectSurfaces(room, found);
  ExpectServed(room, found);
}

TEST_F(DiscoverPlanesTest, LeavesOutPlanesThatAreNotWorthTheirCost) {
  const DrawnRoom room;
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

TEST_F(DiscoverPlanesTest, StopsAtTheMaximumOfPlanes) {
  const DrawnRoom room;
  options_.max_planes = 2;
  const std::vector<ScenePlane> found = Discover(room).planes;
  ASSERT_EQ(found.size(), 2u);
  EXPECT_GE(Find(room.surfaces[kWall], found), 0);
}

TEST_F(DiscoverPlanesTest, MergesPlanesThatOneCanReplace) {
  // Two strips turned by opposite angles: neither's plane comes near the other
  // one, but a plane between them fits both nearly as well.
  const Eigen::Vector3d direction(0.0, 0.0, -1.0);
  const Eigen::Vector3d left(-1.5, 0.4, 3.5);
  const Eigen::Vector3d right(0.9, 0.4, 3.5);
  const DrawnRoom room({Board({0.02, 0.0, -1.0}, left, 0.4),
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

// Two boards side by side, one a little before the other, and the plane between
// them, which explains more than either one's.
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

  const DrawnRoom room_{
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
  static DrawnRoom RoomWithBoard(double degrees) {
    const Eigen::Vector3d wall = DrawnRoom().surfaces[kWall].plane.normal;
    return DrawnRoom({Board(
        wall + std::tan(degrees * M_PI / 180.0) * Eigen::Vector3d::UnitY(),
        {-0.2, 0.4, 3.5},
        0.9)});
  }

  WorldPlane FindBoard(const DrawnRoom& room, bool regular) {
    options_.regular_directions = regular;
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
  const DrawnRoom room = RoomWithBoard(0.4);
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
}

TEST_F(LeaningBoardTest, StaysWhereItLeansByMuch) {
  const DrawnRoom room = RoomWithBoard(3.0);
  const WorldPlane leaning = FindBoard(room, false);
  EXPECT_LT(AngleBetween(leaning, room.surfaces[kBoard].plane), 0.15);
  EXPECT_LT(AngleBetween(FindBoard(room, true), leaning), 0.15);
}

TEST_F(DiscoverPlanesTest, FitsAllViewsAlike) {
  DrawnRoom room;
  for (Observation& observation : room.evidence[0].observations) {
    observation.sample.z *=
        1.f + 0.4f * DrawnRoom::kErrorPerDepth * observation.sample.z;
  }
  const std::vector<ScenePlane> found = Discover(room).planes;
  // The largest, of more observations than a fit uses. A third of 0.4 times
  // 0.025; more than three fourths of it, were the first ones used.
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(
      found[0].plane.Height(room.surfaces[kWall].middle), 0.0033, 0.0012);
}

TEST_F(DiscoverPlanesTest, TakesTheFirstOfEqualCandidates) {
  const DrawnRoom room;
  const WorldPlane& plane = room.surfaces[kWall].plane;
  for (const double sign : {1.0, -1.0}) {
    const WorldPlane first = {sign * plane.normal, sign * plane.offset};
    const WorldPlane second = {-first.normal, -first.offset};
    const std::vector<ScenePlane> found =
        Discover(room, {first, second}).planes;
    ASSERT_EQ(found.size(), 1u);
    EXPECT_GT(found[0].plane.normal.dot(first.normal), 0.9);
  }
}

TEST_F(DiscoverPlanesTest, MakesNoPlanesOfNoise) {
  DrawnRoom room;
  Philox random(11, 0, 0);
  std::vector<WorldPlane> candidates = room.Candidates();
  for (int view = 0; view < 3; ++view) {
    for (int k = 0; k < DrawnRoom::kNumSuperpixels; k += 4) {
      room.MakeNoise(view, k, &random);
      const int first = room.evidence[view].first_observation[k];
      Eigen::Vector3d points[3];
      for (int i = 0; i < 3; ++i) {
        const RayDepth& sample =
            room.evidence[view].observations[first + 10 * i].sample;
        points[i] =
            room.cameras[view].rotation.transpose() *
                Eigen::Vector3d(
                    sample.x * sample.z, sample.y * sample.z, sample.z) +
            room.cameras[view].Center();
      }
      candidates.push_back(PlaneThrough(
          (points[1] - points[0]).cross(points[2] - points[0]), points[0]));
    }
  }
  ExpectSurfaces(room, Discover(room, candidates));
  // Nor where there is nothing else.
  for (int view = 0; view < 3; ++view) {
    for (int k = 0; k < DrawnRoom::kNumSuperpixels; ++k) {
      room.MakeNoise(view, k, &random);
    }
  }
  const DiscoveredPlanes found = Discover(room, candidates);
  EXPECT_TRUE(found.planes.empty());
  for (const std::vector<int>& of_view : found.serving) {
    EXPECT_EQ(of_view, std::vector<int>(DrawnRoom::kNumSuperpixels, -1));
  }
}

TEST_F(DiscoverPlanesTest, CountsASuperpixelByItsMassUpToTheMaximum) {
  DrawnRoom room;
  const double full = Discover(room).planes[0].support;
  for (ViewEvidence& evidence : room.evidence) {
    evidence.mass.assign(evidence.mass.size(), 1e4f);
  }
  EXPECT_DOUBLE_EQ(Discover(room).planes[0].support, full);
  for (ViewEvidence& evidence : room.evidence) {
    evidence.mass.assign(evidence.mass.size(), 20.f);
  }
  EXPECT_NEAR(Discover(room).planes[0].support, 0.5 * full, 1e-3 * full);
}

TEST_F(DiscoverPlanesTest, DoesNotDependOnTheScale) {
  DrawnRoom room;
  const DiscoveredPlanes small = Discover(room);
  room.Transform(1000.0, Eigen::Vector3d::Zero());
  std::vector<WorldPlane> candidates = DrawnRoom().Candidates();
  for (WorldPlane& candidate : candidates) {
    candidate.offset *= 1000.0;
  }
  const DiscoveredPlanes found = Discover(room, candidates);
  ExpectSurfaces(room, found, 1000.0);
  EXPECT_EQ(found.serving, small.serving);
}

TEST_F(DiscoverPlanesTest, DoesNotDependOnTheOrigin) {
  DrawnRoom room;
  const DiscoveredPlanes near = Discover(room);
  const Eigen::Vector3d shift(1e6, -3e6, 2e5);
  room.Transform(1.0, shift);
  std::vector<WorldPlane> candidates = DrawnRoom().Candidates();
  for (WorldPlane& candidate : candidates) {
    candidate.offset -= candidate.normal.dot(shift);
  }
  const DiscoveredPlanes found = Discover(room, candidates);
  ASSERT_EQ(found.planes.size(), near.planes.size());
  for (size_t i = 0; i < found.planes.size(); ++i) {
    EXPECT_LT(AngleBetween(found.planes[i].plane, near.planes[i].plane), 1e-4);
    const Eigen::Vector3d point(-0.8, 0.5, 4.5);
    EXPECT_NEAR(found.planes[i].plane.Height(shift + point),
                near.planes[i].plane.Height(point),
                1e-5);
  }
  EXPECT_EQ(found.serving, near.serving);
}

TEST_F(DiscoverPlanesTest, FindsTheSamePlanesWithTheViewsInAnotherOrder) {
  DrawnRoom room({Poster()});
  const DiscoveredPlanes found = Discover(room);
  const std::vector<WorldPlane> candidates = room.Candidates();
  std::rotate(
      room.cameras.begin(), room.cameras.begin() + 1, room.cameras.end());
  std::rotate(
      room.evidence.begin(), room.evidence.begin() + 1, room.evidence.end());
  const DiscoveredPlanes other = Discover(room, candidates);
  ASSERT_EQ(other.planes.size(), found.planes.size());
  for (size_t i = 0; i < found.planes.size(); ++i) {
    EXPECT_LT(AngleBetween(other.planes[i].plane, found.planes[i].plane), 0.02);
    const Eigen::Vector3d point(-0.8, 0.5, 4.5);
    EXPECT_NEAR(other.planes[i].plane.Height(point),
                found.planes[i].plane.Height(point),
                1e-3);
  }
}

TEST_F(DiscoverPlanesTest, GivesTheSameBitsWithAnyNumberOfThreads) {
  const DrawnRoom room({Poster()});
  const DiscoveredPlanes found = Discover(room);
  for (const int num_threads : {2, 5}) {
    device_ = Device::CreateCpu(num_threads);
    ExpectSameBits(Discover(room), found);
  }
}

TEST_F(DiscoverPlanesTest, BearsCandidatesThatAreNoPlanes) {
  const DrawnRoom room;
  const DiscoveredPlanes found = Discover(room);
  std::vector<WorldPlane> candidates = room.Candidates();
  candidates.push_back({Eigen::Vector3d::Constant(NAN), 1.0});
  candidates.push_back({Eigen::Vector3d::UnitX(), INFINITY});
  ExpectSameBits(Discover(room, candidates), found);
}

TEST_F(DiscoverPlanesTest, LeavesOutTheLastCandidatesThatDoNotFit) {
  const DrawnRoom room;
  options_.max_scores = 2 * 3 * DrawnRoom::kNumSuperpixels;
  std::vector<WorldPlane> candidates;
  for (const DrawnSurface& surface : room.surfaces) {
    candidates.push_back(surface.plane);
  }
  const std::vector<ScenePlane> found = Discover(room, candidates).planes;
  ASSERT_EQ(found.size(), 2u);
  EXPECT_GE(Find(room.surfaces[kWall], found), 0);
  EXPECT_GE(Find(room.surfaces[kLeft], found), 0);
  EXPECT_EQ(Find(room.surfaces[kFloor], found), -1);
}

TEST_F(DiscoverPlanesTest, FindsNothingInNothing) {
  DrawnRoom room;
  const std::vector<WorldPlane> candidates = room.Candidates();
  EXPECT_TRUE(
      DiscoverPlanes({}, candidates, options_, *device_).planes.empty());

  const DiscoveredPlanes without_candidates = Discover(room, {});
  EXPECT_TRUE(without_candidates.planes.empty());
  ASSERT_EQ(without_candidates.serving.size(), 3u);
  EXPECT_EQ(without_candidates.serving[1],
            std::vector<int>(DrawnRoom::kNumSuperpixels, -1));

  for (ViewEvidence& evidence : room.evidence) {
    evidence.observations.clear();
    evidence.first_observation.assign(evidence.first_observation.size(), 0);
  }
  const DiscoveredPlanes without_observations = Discover(room, candidates);
  EXPECT_TRUE(without_observations.planes.empty());
  EXPECT_EQ(without_observations.serving, without_candidates.serving);

  room.evidence.assign(3, ViewEvidence());
  const DiscoveredPlanes without_superpixels = Discover(room, candidates);
  EXPECT_TRUE(without_superpixels.planes.empty());
  EXPECT_EQ(without_superpixels.serving, std::vector<std::vector<int>>(3));
}

}  // namespace
}  // namespace tsar
