// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/nearest_distance.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace tsar {
namespace {

const double kInfinity = std::numeric_limits<double>::infinity();

TEST(NearestDistances, AreThoseOfAnExhaustiveSearch) {
  Philox random(1, 0, 0);
  const auto draw = [&](int count) {
    std::vector<Eigen::Vector3d> points(count);
    for (Eigen::Vector3d& point : points) {
      point = {random.NextFloat(), random.NextFloat(), random.NextFloat()};
    }
    return points;
  };
  const auto queries = draw(500);
  const auto targets = draw(300);
  const double max_distance = 0.08;
  const auto distances = NearestDistances(queries, targets, max_distance);
  int num_far = 0;
  for (size_t i = 0; i < queries.size(); ++i) {
    double expected = kInfinity;
    for (const Eigen::Vector3d& target : targets) {
      expected = std::min(expected, (queries[i] - target).norm());
    }
    if (expected > max_distance) {
      EXPECT_EQ(distances[i], kInfinity);
      ++num_far;
    } else {
      EXPECT_NEAR(distances[i], expected, 1e-12);
    }
  }
  EXPECT_GT(num_far, 50);
  EXPECT_LT(num_far, 450);
}

TEST(NearestDistances, IncludeWhatLiesExactlyAtTheMaximum) {
  const auto distances = NearestDistances(
      {{0, 0, 0}, {0.25, 0, 0}, {-1e-6, 0, 0}}, {{0.5, 0, 0}}, 0.5);
  EXPECT_EQ(distances[0], 0.5);
  EXPECT_EQ(distances[1], 0.25);
  EXPECT_EQ(distances[2], kInfinity);
}

TEST(NearestDistances, AreInfiniteWithoutTargets) {
  EXPECT_EQ(NearestDistances({{0, 0, 0}}, {}, 1),
            std::vector<double>{kInfinity});
  EXPECT_TRUE(NearestDistances({}, {{0, 0, 0}}, 1).empty());
}

}  // namespace
}  // namespace tsar
