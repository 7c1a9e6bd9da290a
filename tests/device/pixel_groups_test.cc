// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/pixel_groups.h"

#include "colmap_tsar/base/random.h"

#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

void ExpectGroups(const Image<int>& labels, int num_labels) {
  std::vector<int> begin = {0};
  std::vector<int> pixels;
  for (int k = 0; k < num_labels; ++k) {
    for (size_t i = 0; i < labels.NumPixels(); ++i) {
      if (labels.Data()[i] == k) {
        pixels.push_back(static_cast<int>(i));
      }
    }
    begin.push_back(static_cast<int>(pixels.size()));
  }
  for (size_t i = 0; i < labels.NumPixels(); ++i) {
    if (labels.Data()[i] < 0) {
      pixels.push_back(static_cast<int>(i));
    }
  }
  const auto device = Device::CreateCpu(2);
  const PixelGroups groups = GroupPixels(labels.View(), num_labels, *device);
  EXPECT_EQ(groups.NumGroups(), num_labels);
  EXPECT_EQ(groups.begin.ToHost(), begin);
  EXPECT_EQ(groups.pixels.ToHost(), pixels);
}

TEST(GroupPixels, ListsPixelsInRasterOrder) {
  Image<int> labels(3, 2, 0);
  labels(1, 0) = 1;
  labels(0, 1) = 1;
  ExpectGroups(labels, 2);
}

TEST(GroupPixels, ListsNegativeLabelsLastAndKeepsEmptyOnes) {
  Image<int> labels(19, 11);
  Philox random(1, 0, 0);
  for (int& label : labels) {
    // 0, 3 and 9 stay without pixels.
    label = static_cast<int>(random.NextBelow(10)) - 2;
    label = label == 0 || label == 3 ? -1 : label;
  }
  ExpectGroups(labels, 10);
}

TEST(GroupPixels, MayFindNothing) {
  ExpectGroups(Image<int>(5, 4, -1), 3);
  ExpectGroups(Image<int>(5, 4, -7), 0);
}

}  // namespace
}  // namespace tsar
