// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/discover_planes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/scene/discovery/discover_planes_fixture.h"
#include "tests/support/synthetic_room.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(DiscoverPlanesTest, SupportIsTheSumOfTheScores) {
  const SyntheticRoom room;
  const DiscoveredPlanes found = Discover(room);
  ASSERT_EQ(found.planes.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const double support = SupportOf(i, found, room.Views());
    EXPECT_NEAR(found.planes[i].support, support, 1e-4 * support);
  }
}

TEST_F(DiscoverPlanesTest, BoundsTheSlopeOfGrazingRays) {
  // A floor just below the camera; all rays meet it at less than 3 degrees.
  const WorldPlane floor = PlaneThrough({0.0, -1.0, 0.0}, {0.0, 0.1, 0.0});
  constexpr int kNumSuperpixels = 20;
  ViewEvidence evidence;
  evidence.resolution.error_per_depth = SyntheticRoom::kErrorPerDepth;
  evidence.weights.assign(kNumSuperpixels, 100.f);
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
      evidence.sources.push_back(ObservationSource::kMeasured);
    }
    evidence.first_observation.push_back(10 * (k + 1));
  }
  const std::vector<ObservedView> views = {{&evidence, Camera()}};
  const DiscoveredPlanes found =
      DiscoverPlanes(views, {floor}, options_, *device_);
  ASSERT_EQ(found.planes.size(), 1u);
  EXPECT_LT(AngleBetween(found.planes[0].plane, floor), 0.1);
  const double support = SupportOf(0, found, views);
  EXPECT_NEAR(found.planes[0].support, support, 1e-4 * support);
}

TEST_F(DiscoverPlanesTest, DoesNotHingeOnOneObservation) {
  SyntheticRoom room;
  const std::vector<ScenePlane> found = Discover(room).planes;
  // All indices of observations after this one change.
  ViewEvidence& evidence = room.evidence[0];
  evidence.observations.erase(evidence.observations.begin());
  evidence.sources.erase(evidence.sources.begin());
  for (size_t k = 1; k < evidence.first_observation.size(); ++k) {
    --evidence.first_observation[k];
  }
  const std::vector<ScenePlane> without = Discover(room).planes;
  ASSERT_EQ(without.size(), found.size());
  for (size_t p = 0; p < found.size(); ++p) {
    const Eigen::Vector3d& middle = room.surfaces[p].middle;
    // Each of thousands of depths errs by about 0.02.
    EXPECT_NEAR(
        without[p].plane.Height(middle), found[p].plane.Height(middle), 3e-5);
    EXPECT_LT(AngleBetween(without[p].plane, found[p].plane), 1e-3);
  }
}

TEST_F(DiscoverPlanesTest, MakesNoPlanesOfNoise) {
  SyntheticRoom room;
  Philox random(11, 0, 0);
  std::vector<WorldPlane> candidates = room.Candidates();
  for (int view = 0; view < 3; ++view) {
    for (int k = 0; k < SyntheticRoom::kNumSuperpixels; k += 4) {
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
}

TEST_F(DiscoverPlanesTest, DependsNeitherOnTheUnitNorOnTheOrigin) {
  const SyntheticRoom room;
  const DiscoveredPlanes expected = Discover(room);
  const std::pair<double, Eigen::Vector3d> cases[] = {
      {1000.0, Eigen::Vector3d::Zero()}, {1.0, {1e6, -3e6, 2e5}}};
  for (const auto& [unit, origin] : cases) {
    SCOPED_TRACE(unit);
    SyntheticRoom moved;
    moved.Transform(unit, origin);
    std::vector<WorldPlane> candidates = room.Candidates();
    for (WorldPlane& candidate : candidates) {
      candidate.offset = unit * candidate.offset - candidate.normal.dot(origin);
    }
    const DiscoveredPlanes found = Discover(moved, candidates);
    ASSERT_EQ(found.planes.size(), expected.planes.size());
    for (size_t i = 0; i < found.planes.size(); ++i) {
      const WorldPlane& plane = expected.planes[i].plane;
      EXPECT_LT(AngleBetween(found.planes[i].plane, plane), 1e-4);
      const Eigen::Vector3d point(-0.8, 0.5, 4.5);
      EXPECT_NEAR(found.planes[i].plane.Height(unit * point + origin) / unit,
                  plane.Height(point),
                  1e-5);
    }
    EXPECT_EQ(found.assignment, expected.assignment);
  }
}

TEST_F(DiscoverPlanesTest, FindsTheSamePlanesWithTheViewsInAnotherOrder) {
  SyntheticRoom room({Poster()});
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
  const SyntheticRoom room({Poster()});
  const DiscoveredPlanes found = Discover(room);
  for (const int num_threads : {2, 5}) {
    device_ = Device::CreateCpu(num_threads);
    ExpectSameBits(Discover(room), found);
  }
}

TEST_F(DiscoverPlanesTest, BearsCandidatesThatAreNoPlanes) {
  const SyntheticRoom room;
  const DiscoveredPlanes found = Discover(room);
  std::vector<WorldPlane> candidates = room.Candidates();
  candidates.push_back({Eigen::Vector3d::Constant(NAN), 1.0});
  candidates.push_back({Eigen::Vector3d::UnitX(), INFINITY});
  ExpectSameBits(Discover(room, candidates), found);
}

TEST_F(DiscoverPlanesTest, FindsNothingInNothing) {
  SyntheticRoom room;
  const std::vector<WorldPlane> candidates = room.Candidates();
  EXPECT_TRUE(
      DiscoverPlanes({}, candidates, options_, *device_).planes.empty());
  EXPECT_TRUE(Discover(room, {}).planes.empty());
  room.evidence.assign(3, ViewEvidence());
  const DiscoveredPlanes found = Discover(room, candidates);
  EXPECT_TRUE(found.planes.empty());
  EXPECT_EQ(found.assignment, std::vector<std::vector<int>>(3));
}

TEST_F(DiscoverPlanesTest, LeavesOutTheLastCandidatesThatDoNotFit) {
  const SyntheticRoom room;
  options_.max_scores = 2 * 3 * SyntheticRoom::kNumSuperpixels;
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

}  // namespace
}  // namespace tsar
