// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tsar {

// The place of a row or column between two of another raster of the same
// photo; beyond the outermost both are that one.
struct PlaceBetween {
  size_t first = 0;
  size_t second = 0;
  float share = 0.f;  // Of the second, in [0, 1].
};

// The places of all `size` rows or columns among `other_size`.
inline std::vector<PlaceBetween> PlacesBetween(int other_size, int size) {
  std::vector<PlaceBetween> places;
  for (int i = 0; i < size; ++i) {
    const float at = std::max((i + 0.5f) * other_size / size - 0.5f, 0.f);
    const int first = std::min(static_cast<int>(at), other_size - 1);
    places.push_back({static_cast<size_t>(first),
                      static_cast<size_t>(std::min(first + 1, other_size - 1)),
                      std::min(at - static_cast<float>(first), 1.f)});
  }
  return places;
}

}  // namespace tsar
