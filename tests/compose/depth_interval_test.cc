// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/depth_interval.h"

#include <optional>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(SparseDepthInterval, IsThatOfThePointsInFrontWidened) {
  SparseModel model;
  model.images.resize(2);
  model.images[0].camera.translation = {0, 0, 1};
  for (int i = 0; i < 101; ++i) {
    model.points.push_back({0, 0, 1.0 + i});
    model.images[0].point_indices.push_back(i);
  }
  model.points.push_back({0, 0, -50});
  model.images[0].point_indices.push_back(101);
  const std::optional<DepthInterval> range = SparseDepthInterval(model, 0);
  ASSERT_TRUE(range);
  // Depths 2 to 102; one in a hundred is left out at either end.
  EXPECT_DOUBLE_EQ(range->min, 3 * 0.75);
  EXPECT_DOUBLE_EQ(range->max, 101 * 1.25);
  EXPECT_FALSE(SparseDepthInterval(model, 1));
}

}  // namespace
}  // namespace tsar
