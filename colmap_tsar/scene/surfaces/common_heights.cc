// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/common_heights.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tsar {
namespace {

// Limits in bins.
constexpr int kMaxGap = 8;
constexpr double kMaxBins = 20000.0;

void AddView(std::vector<double> heights,
             double lowest,
             double bin,
             std::vector<size_t>* num_views) {
  std::sort(heights.begin(), heights.end());
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

// The runs of bins with enough views, as half-open ranges.
std::vector<std::pair<size_t, size_t>> RunsOf(
    const std::vector<size_t>& num_views, size_t min_views) {
  std::vector<std::pair<size_t, size_t>> runs;
  size_t begin = 0;
  for (size_t i = 0; i <= num_views.size(); ++i) {
    if (i < num_views.size() && num_views[i] >= min_views) {
      continue;
    }
    if (i > begin) {
      runs.emplace_back(begin, i);
    }
    begin = i + 1;
  }
  return runs;
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
  std::vector<HeightRange> ranges;
  for (const auto& [begin, end] : RunsOf(num_views, min_views)) {
    ranges.push_back({lowest + bin * static_cast<double>(begin),
                      lowest + bin * static_cast<double>(end)});
  }
  return ranges;
}

}  // namespace tsar
