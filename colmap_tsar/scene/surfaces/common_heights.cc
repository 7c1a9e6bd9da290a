// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/common_heights.h"

#include <cmath>

namespace tsar {
namespace {

// Limits in bins.
constexpr int kMaxGap = 8;
constexpr double kMaxBins = 20000.0;

void AddView(std::vector<double> heights,
             double lowest,
             double bin,
             std::vector<size_t>* num_views) {
  std::ranges::sort(heights);
  int last = -1;
  for (const double height : heights) {
    const int i = static_cast<int>((height - lowest) / bin);
    const int first = last >= 0 && i - last <= kMaxGap ? last + 1 : i;
    for (int k = first; k <= i; ++k) {
      ++(*num_views)[k];
    }
    last = i;
  }
}

}  // namespace

std::vector<HeightRange> FindCommonHeights(
    const std::vector<std::vector<double>>& heights,
    double bin,
    size_t min_views) {
  double lowest = INFINITY;
  double highest = -INFINITY;
  for (const std::vector<double>& of_view : heights) {
    for (const double height : of_view) {
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
    }
  }
  if (!((highest - lowest) / bin < kMaxBins) || !(lowest <= highest)) {
    return {};
  }
  std::vector<size_t> num_views(
      static_cast<size_t>((highest - lowest) / bin) + 1, 0);
  for (const std::vector<double>& of_view : heights) {
    AddView(of_view, lowest, bin, &num_views);
  }
  const auto is_common = [&](size_t i) { return num_views[i] >= min_views; };
  std::vector<HeightRange> ranges;
  for (const auto& [begin, end] : RunsOf(num_views.size(), is_common)) {
    ranges.push_back({lowest + bin * begin, lowest + bin * end});
  }
  return ranges;
}

}  // namespace tsar
