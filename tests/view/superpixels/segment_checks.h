// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {

// Checks that labels are 0 ... count - 1, all of them used, and that the pixels
// of each are 4-connected. Returns the sizes of the segments.
inline std::vector<int> CheckSegments(const Image<int>& labels, int count) {
  std::vector<int> sizes(count, 0);
  std::vector<int> num_parts(count, 0);
  Image<char> seen(labels.Width(), labels.Height(), 0);
  for (int y = 0; y < labels.Height(); ++y) {
    for (int x = 0; x < labels.Width(); ++x) {
      const int label = labels(x, y);
      if (label < 0 || label >= count) {
        ADD_FAILURE() << "label " << label << " at " << x << ", " << y;
        return sizes;
      }
      ++sizes[label];
      if (seen(x, y)) {
        continue;
      }
      ++num_parts[label];
      std::vector<std::pair<int, int>> front = {{x, y}};
      seen(x, y) = 1;
      while (!front.empty()) {
        const auto [column, row] = front.back();
        front.pop_back();
        for (const auto& [dx, dy] : {std::pair(1, 0),
                                     std::pair(-1, 0),
                                     std::pair(0, 1),
                                     std::pair(0, -1)}) {
          const int c = column + dx;
          const int r = row + dy;
          if (labels.Contains(c, r) && labels(c, r) == label && !seen(c, r)) {
            seen(c, r) = 1;
            front.push_back({c, r});
          }
        }
      }
    }
  }
  EXPECT_EQ(num_parts, std::vector<int>(count, 1));
  return sizes;
}

}  // namespace tsar
