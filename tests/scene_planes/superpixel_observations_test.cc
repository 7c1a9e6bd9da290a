// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/superpixel_observations.h"

#include <cmath>
#include <set>

#include "tests/support/synthetic_room.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kCount = SyntheticRoom::kNumSuperpixels;

// The superpixels of other views into which observations of one fall.
std::set<int> Projections(const SyntheticRoom& room, int view, int superpixel) {
  std::set<int> result;
  const ViewEvidence& evidence = room.evidence[view];
  for (int i = evidence.first_observation[superpixel];
       i < evidence.first_observation[superpixel + 1];
       ++i) {
    const RayDepth& sample = evidence.observations[i].sample;
    const Camera& own = room.cameras[view];
    const Eigen::Vector3d point =
        own.Center() + own.rotation.transpose() *
                           (sample.z * Eigen::Vector3d(sample.x, sample.y, 1));
    for (int other = 0; other < static_cast<int>(room.cameras.size());
         ++other) {
      const Camera& camera = room.cameras[other];
      const Eigen::Vector3d there =
          camera.rotation * point + camera.translation;
      const double x =
          std::round(camera.fx * there.x() / there.z() + camera.cx);
      const double y =
          std::round(camera.fy * there.y() / there.z() + camera.cy);
      if (other != view && there.z() > 0.0 && x >= 0.0 && y >= 0.0 &&
          x < camera.width && y < camera.height) {
        result.insert(other * kCount +
                      room.evidence[other].superpixels(static_cast<int>(x),
                                                       static_cast<int>(y)));
      }
    }
  }
  return result;
}

TEST(SuperpixelObservationsTest, KnowWhereOtherViewsSeeThem) {
  const SyntheticRoom room;
  const SuperpixelObservations observations(room.Views(), 40.0);
  ASSERT_EQ(observations.Count(), 3 * kCount);
  int num_seen = 0;
  for (int k = 0; k < observations.Count(); ++k) {
    const int view = k / kCount;
    const std::set<int> expected = Projections(room, view, k % kCount);
    std::set<int> views;
    for (const int there : observations.SeenIn(k)) {
      EXPECT_EQ(expected.count(there), 1u) << "superpixel " << k;
      EXPECT_TRUE(views.insert(there / kCount).second);
      ++num_seen;
    }
    EXPECT_EQ(views.count(view), 0u);
  }
  EXPECT_GT(num_seen, 3 * kCount);
}

TEST(SuperpixelObservationsTest, AreSeenNowhereWithoutObservationsOrViews) {
  SyntheticRoom room;
  EXPECT_TRUE(
      SuperpixelObservations({room.Views()[0]}, 40.0).SeenIn(50).empty());
  ViewEvidence& evidence = room.evidence[1];
  const int count =
      evidence.first_observation[51] - evidence.first_observation[50];
  for (int k = 51; k <= kCount; ++k) {
    evidence.first_observation[k] -= count;
  }
  const auto begin =
      evidence.observations.begin() + evidence.first_observation[50];
  evidence.observations.erase(begin, begin + count);
  const SuperpixelObservations observations(room.Views(), 40.0);
  EXPECT_TRUE(observations.SeenIn(kCount + 50).empty());
  EXPECT_FALSE(observations.SeenIn(kCount + 51).empty());
}

TEST(SuperpixelObservationsTest, OnlyViewsAroundTheirOwnAreAsked) {
  const SyntheticRoom room;
  const std::vector<ObservedView> views(20, room.Views()[0]);
  const SuperpixelObservations observations(views, 40.0);
  EXPECT_EQ(observations.SeenIn(60).size(), 8u);
  for (const int there : observations.SeenIn(10 * kCount + 60)) {
    EXPECT_GE(there / kCount, 2);
    EXPECT_LE(there / kCount, 18);
    EXPECT_EQ(there % kCount, 60);
  }
  EXPECT_EQ(observations.SeenIn(10 * kCount + 60).size(), 16u);
}

}  // namespace
}  // namespace tsar
