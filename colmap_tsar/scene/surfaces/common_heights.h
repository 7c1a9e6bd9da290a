// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace tsar {

// An interval on an axis.
struct HeightRange {
  double min = 0.0;
  double max = 0.0;

  double Length() const { return max - min; }
  HeightRange Intersection(const HeightRange& other) const {
    return {std::max(min, other.min), std::min(max, other.max)};
  }
  // Whether more than a small part of the shorter one is common to both.
  bool Overlaps(const HeightRange& other) const {
    return Intersection(other).Length() >
           kMinOverlap * std::min(Length(), other.Length());
  }

 private:
  static constexpr double kMinOverlap = 0.2;
};

// The runs of indices below `size` for which holds(index), as half-open ranges.
template <typename Predicate>
std::vector<std::pair<size_t, size_t>> RunsOf(size_t size,
                                              const Predicate& holds) {
  std::vector<std::pair<size_t, size_t>> runs;
  size_t begin = 0;
  for (size_t i = 0; i <= size; ++i) {
    if (i < size && holds(i)) {
      continue;
    }
    if (i > begin) {
      runs.emplace_back(begin, i);
    }
    begin = i + 1;
  }
  return runs;
}

// The intervals of an axis with observations in at least min_views views, in
// ascending order. heights: by view, the heights of its observations, either
// ascending or descending. bin: the length that counts as one height; gaps of a
// few bins in one view are closed.
std::vector<HeightRange> FindCommonHeights(
    const std::vector<std::vector<double>>& heights,
    double bin,
    size_t min_views);

}  // namespace tsar
