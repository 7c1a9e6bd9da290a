// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/connected_components.h"
#include "colmap_tsar/device/scan_and_sort.h"

#include <utility>
#include <vector>

#include "tests/device/drawn_components.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// The reference: flood-fills from each pixel in raster order.
Image<int> Flood(const Image<int>& values, bool eight) {
  Image<int> labels(values.Width(), values.Height(), -1);
  const SimilarValue relation{values.Data()};
  for (size_t seed = 0; seed < values.NumPixels(); ++seed) {
    if (!relation.Contains(static_cast<int>(seed)) ||
        labels.Data()[seed] >= 0) {
      continue;
    }
    std::vector<int> front = {static_cast<int>(seed)};
    labels.Data()[seed] = static_cast<int>(seed);
    while (!front.empty()) {
      const int i = front.back();
      front.pop_back();
      const int x = i % values.Width();
      const int y = i / values.Width();
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          if ((!eight && dx != 0 && dy != 0) ||
              !values.Contains(x + dx, y + dy)) {
            continue;
          }
          const int j = (y + dy) * values.Width() + x + dx;
          if (relation.Contains(j) && relation.Connected(i, j) &&
              labels.Data()[j] < 0) {
            labels.Data()[j] = static_cast<int>(seed);
            front.push_back(j);
          }
        }
      }
    }
  }
  return labels;
}

void ExpectSameAsFlood(const Image<int>& values) {
  for (const int num_threads : {1, 2, 7}) {
    const auto device = Device::CreateCpu(num_threads);
    for (const bool eight : {false, true}) {
      Image<int> labels(values.Width(), values.Height());
      LabelComponents(*device,
                      SimilarValue{values.Data()},
                      eight ? Connectivity::kEight : Connectivity::kFour,
                      labels.View());
      const Image<int> expected = Flood(values, eight);
      ASSERT_EQ(std::vector<int>(labels.begin(), labels.end()),
                std::vector<int>(expected.begin(), expected.end()))
          << num_threads << " threads, eight = " << eight;

      std::vector<int> sizes(labels.NumPixels(), 0);
      CountComponentPixels(*device, labels.View(), sizes.data());
      std::vector<int> expected_sizes(labels.NumPixels(), 0);
      for (const int label : expected) {
        if (label >= 0) {
          ++expected_sizes[label];
        }
      }
      ASSERT_EQ(sizes, expected_sizes);
    }
  }
}

TEST(LabelComponents, AgreesWithAFloodFillOnNoise) {
  const std::vector<std::pair<int, int>> sizes = {
      {1, 1}, {1, 23}, {23, 1}, {2, 2}, {13, 17}, {61, 47}, {128, 64}};
  uint32_t seed = 0;
  for (const auto& [width, height] : sizes) {
    for (const int num_values : {2, 3, 5, 8}) {
      ExpectSameAsFlood(DrawNoise(width, height, num_values, ++seed));
    }
  }
}

TEST(LabelComponents, AgreesWithAFloodFillOnCorridorsAndWhereAllAreEqual) {
  for (const Image<int>& values : {DrawSpiral(41, 41),
                                   DrawSnake(67, 43, true),
                                   DrawSnake(67, 43, false),
                                   Image<int>(97, 61, 3),
                                   Image<int>(97, 61, -1)}) {
    ExpectSameAsFlood(values);
  }
}

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

TEST(GroupPixels, ListsNegativeLabelsLastAndKeepsEmptyOnes) {
  Image<int> labels(19, 11);
  Philox random(1, 0, 0);
  for (int& label : labels) {
    // Labels 0, 3 and 9 stay without pixels.
    label = static_cast<int>(random.NextBelow(10)) - 2;
    label = label == 0 || label == 3 ? -1 : label;
  }
  ExpectGroups(labels, 10);
}

}  // namespace
}  // namespace tsar
