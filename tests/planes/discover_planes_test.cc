// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/planes/discover_planes.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/planes/drawn_room.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWall = 0;
constexpr int kLeft = 1;
constexpr int kFloor = 2;
constexpr int kPoster = 3;

// Three expected errors before the back wall.
DrawnSurface Poster() {
  const DrawnSurface wall = DrawnRoom().surfaces[kWall];
  const Eigen::Vector3d middle = wall.middle + 0.075 * wall.plane.normal;
  return {PlaneThrough(wall.plane.normal, middle),
          middle,
          [middle](const Eigen::Vector3d& point) {
            return std::abs(point.x() - middle.x()) < 1.0 &&
                   std::abs(point.y() - middle.y()) < 0.8;
          }};
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

TEST_F(DiscoverPlanesTest, SortsByTheSumOfTheScores) {
  const DrawnRoom room;
  DisparityScale scale;
  scale.error_per_depth = DrawnRoom::kErrorPerDepth;
  const DiscoveredPlanes found = Discover(room);
  ASSERT_EQ(found.planes.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    if (i > 0) {
      EXPECT_LE(found.planes[i].support, found.planes[i - 1].support);
    }
    double support = 0.0;
    for (size_t view = 0; view < 3; ++view) {
      const ViewEvidence& evidence = room.evidence[view];
      for (int k = 0; k < DrawnRoom::kNumSuperpixels; ++k) {
        if (found.serving[view][k] != i) {
          continue;
        }
        double scores = 0.0;
        double qualities = 0.0;
        for (int o = evidence.first_observation[k];
             o < evidence.first_observation[k + 1];
             ++o) {
          const RayDepth& sample = evidence.observations[o].sample;
          const Camera& camera = room.cameras[view];
          DepthObservation observation;
          observation.center = camera.Center();
          observation.ray = camera.rotation.transpose() *
                            Eigen::Vector3d(sample.x, sample.y, 1.0);
          observation.depth = sample.z;
          observation.sigma = sample.z * scale.RelativeDepthError(sample.z);
          const double residual =
              NormalizedResidual(found.planes[i].plane, observation);
          scores += evidence.observations[o].quality *
                    std::max(1.0 - residual * residual, 0.0);
          qualities += evidence.observations[o].quality;
        }
        support += options_.max_mass * scores / qualities;
      }
    }
    EXPECT_NEAR(found.planes[i].support, support, 1e-4 * support);
  }
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
  options_.min_gain = all[2].support + 1.0;
  ASSERT_LT(options_.min_gain, all[1].support);
  const std::vector<ScenePlane> found = Discover(room, candidates).planes;
  ASSERT_EQ(found.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(found[i].support, all[i].support, 0.02 * all[i].support);
  }
  options_.min_gain = 1e6;
  EXPECT_TRUE(Discover(room, candidates).planes.empty());
}

TEST_F(DiscoverPlanesTest, StopsAtTheMaximumOfPlanes) {
  const DrawnRoom room;
  options_.max_planes = 2;
  const std::vector<ScenePlane> found = Discover(room).planes;
  ASSERT_EQ(found.size(), 2u);
  EXPECT_GE(Find(room.surfaces[kWall], found), 0);
}

TEST_F(DiscoverPlanesTest, MergesTwoHalvesOfAPlane) {
  // Each candidate fits one end of the back wall; none fits all of it.
  const DrawnRoom room;
  const WorldPlane& wall = room.surfaces[kWall].plane;
  std::vector<WorldPlane> candidates;
  for (const double x : {-1.7, 0.9}) {
    const Eigen::Vector3d end(x, 0.0, 5.0);
    const Eigen::Vector3d on_wall = end - wall.Height(end) * wall.normal;
    const double angle = (x < 0.0 ? 1.0 : -1.0) * 0.03;
    candidates.push_back(PlaneThrough(
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) * wall.normal,
        on_wall));
  }
  const std::vector<ScenePlane> found = Discover(room, candidates).planes;
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(Find(room.surfaces[kWall], found), 0);
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
