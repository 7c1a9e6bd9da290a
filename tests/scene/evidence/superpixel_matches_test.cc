// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/superpixel_matches.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

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

TEST(SuperpixelMatchesTest, AreWhereObservationsFallInOtherViews) {
  const SyntheticRoom room;
  const SuperpixelMatches matches(room.Views());
  int num_matches = 0;
  for (int k = 0; k < 3 * kCount; ++k) {
    const int view = k / kCount;
    const std::set<int> expected = Projections(room, view, k % kCount);
    std::set<int> views;
    for (const int match : matches.Of(k)) {
      EXPECT_EQ(expected.count(match), 1u) << "superpixel " << k;
      EXPECT_TRUE(views.insert(match / kCount).second);
      ++num_matches;
    }
    EXPECT_EQ(views.count(view), 0u);
  }
  EXPECT_GT(num_matches, 3 * kCount);
}

TEST(SuperpixelMatchesTest, AreNoneOfOtherSurfaces) {
  SyntheticRoom room;
  const SuperpixelMatches before(room.Views());
  ASSERT_FALSE(before.Of(50).empty());
  // What the other views measure moves 10 % nearer.
  for (const size_t view : {1, 2}) {
    for (Observation& observation : room.evidence[view].observations) {
      observation.sample.z *= 0.9f;
    }
  }
  const SuperpixelMatches after(room.Views());
  for (const int match : before.Of(50)) {
    const std::span<const int> left = after.Of(50);
    EXPECT_EQ(std::count(left.begin(), left.end(), match), 0);
  }
}

}  // namespace
}  // namespace tsar
