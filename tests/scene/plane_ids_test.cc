// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/find_scene.h"

#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

// A raster in which each superpixel is one pixel, labeled with the place of
// its plane among these.
std::vector<uint16_t> NumbersOf(const std::vector<int>& labels,
                                const std::vector<int>& plane_indices) {
  FoundScene found;
  found.labels.planes = labels;
  found.plane_indices = plane_indices;
  Image<uint16_t> superpixels(static_cast<int>(labels.size()), 1);
  for (int x = 0; x < superpixels.Width(); ++x) {
    superpixels(x, 0) = static_cast<uint16_t>(x);
  }
  const Image<uint16_t> numbers = PlaneIds(superpixels, found);
  return {numbers.begin(), numbers.end()};
}

TEST(PlaneIds, AreThoseOfTheModelAndOne) {
  EXPECT_EQ(NumbersOf({1, -1, 0}, {4, 7}), std::vector<uint16_t>({8, 0, 5}));
}

TEST(PlaneIds, LeavePlanesOutThatDoNotFit) {
  EXPECT_EQ(
      NumbersOf({0, 1, 2}, {kMaxPlanesOfMap - 1, kMaxPlanesOfMap, 131072}),
      std::vector<uint16_t>({65535, 0, 0}));
}

}  // namespace
}  // namespace tsar
