// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/discover_planes.h"

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "tests/scene/discovery/discover_planes_fixture.h"
#include "tests/support/synthetic_room.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// The error of observations of priors, in expected errors of measurements.
constexpr float kError = 8.f;

using Choice = std::function<bool(size_t view, int superpixel)>;

// The observations of the chosen superpixels, and of no other, become those of
// a prior, which is this many of its errors too far.
void MakePrior(const Choice& is_chosen, float bias, SyntheticRoom* room) {
  for (size_t view = 0; view < room->evidence.size(); ++view) {
    ViewEvidence& evidence = room->evidence[view];
    evidence.errors.assign(evidence.observations.size(), 1.f);
    for (int k = 0; k < evidence.NumSuperpixels(); ++k) {
      for (int i = evidence.first_observation[k];
           is_chosen(view, k) && i < evidence.first_observation[k + 1];
           ++i) {
        float& z = evidence.observations[i].sample.z;
        z *= 1.f + bias * kError * evidence.resolution.RelativeDepthError(z);
        evidence.sources[i] = ObservationSource::kPrior;
        evidence.errors[i] = kError;
      }
    }
  }
}

// The chosen superpixels get no observations.
void Forget(const Choice& is_chosen, SyntheticRoom* room) {
  for (size_t view = 0; view < room->evidence.size(); ++view) {
    Forget([&](int k, int) { return is_chosen(view, k); },
           &room->evidence[view]);
  }
}

using DiscoverPriorPlanesTest = DiscoverPlanesTest;

TEST_F(DiscoverPriorPlanesTest, FindsAPlaneThatOnlyPriorsKnow) {
  SyntheticRoom without;
  // Nothing that sees the floor was measured.
  const Choice sees_floor = [room = SyntheticRoom()](size_t view, int k) {
    return room.seen[view][k] == kFloor || room.seen[view][k] == -1;
  };
  Forget(sees_floor, &without);
  const DiscoveredPlanes expected = Discover(without);
  EXPECT_EQ(Find(without.surfaces[kFloor], expected.planes), -1);
  ASSERT_EQ(expected.planes.size(), 2u);

  SyntheticRoom room;
  MakePrior(sees_floor, 0.f, &room);
  const DiscoveredPlanes found = Discover(room);
  ASSERT_EQ(found.planes.size(), 3u);
  // It comes last; what is measured is not moved.
  EXPECT_EQ(Find(room.surfaces[kFloor], found.planes), 2);
  EXPECT_GT(found.planes[2].support, options_.min_gain);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(found.planes[i].plane.normal, expected.planes[i].plane.normal);
    EXPECT_EQ(found.planes[i].plane.offset, expected.planes[i].plane.offset);
    EXPECT_EQ(found.planes[i].support, expected.planes[i].support);
  }
  for (size_t view = 0; view < room.seen.size(); ++view) {
    for (size_t k = 0; k < room.seen[view].size(); ++k) {
      if (room.seen[view][k] == kFloor) {
        EXPECT_EQ(found.assignment[view][k], 2);
      } else if (room.seen[view][k] >= 0) {
        EXPECT_EQ(found.assignment[view][k], expected.assignment[view][k]);
      }
    }
  }
}

TEST_F(DiscoverPriorPlanesTest, DoesNotMoveOrDoubleAMeasuredPlane) {
  const Choice is_chosen = [room = SyntheticRoom()](size_t view, int k) {
    return room.seen[view][k] == kWall && k % 2 == 0;
  };
  SyntheticRoom without;
  Forget(is_chosen, &without);
  const DiscoveredPlanes expected = Discover(without);
  ASSERT_EQ(expected.planes.size(), 3u);
  for (const float bias : {-0.9f, 0.9f}) {
    SyntheticRoom room;
    MakePrior(is_chosen, bias, &room);
    // The plane that fits the prior best is proposed as well.
    std::vector<WorldPlane> candidates = room.Candidates();
    WorldPlane moved = room.surfaces[kWall].plane;
    constexpr double kDepth = 5.0;
    moved.offset +=
        bias * kError * SyntheticRoom::kErrorPerDepth * kDepth * kDepth;
    candidates.push_back(moved);
    const DiscoveredPlanes found = Discover(room, candidates);
    ASSERT_EQ(found.planes.size(), 3u);
    for (size_t i = 0; i < found.planes.size(); ++i) {
      EXPECT_EQ(found.planes[i].plane.normal, expected.planes[i].plane.normal);
      EXPECT_EQ(found.planes[i].plane.offset, expected.planes[i].plane.offset);
    }
  }
}

}  // namespace
}  // namespace tsar
