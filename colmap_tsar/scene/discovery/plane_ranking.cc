// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/plane_ranking.h"

#include <cstddef>
#include <cstdint>
#include <utility>

namespace tsar {

void Ranking::Offer(int plane, float score) {
  for (int i = 0; i < 3; ++i) {
    // Ties are in the order of planes.
    if (score > scores[i] || (score == scores[i] && plane < planes[i])) {
      std::swap(plane, planes[i]);
      std::swap(score, scores[i]);
    }
  }
}

std::vector<Ranking> Rank(const std::vector<ScoredPlane>& planes,
                          int num_superpixels,
                          ThreadPool& threads) {
  std::vector<Ranking> rankings(num_superpixels);
  const auto rank = [&](int begin, int end) {
    for (size_t p = 0; p < planes.size(); ++p) {
      const std::vector<int>& superpixels = planes[p].superpixels;
      for (auto k = std::ranges::lower_bound(superpixels, begin);
           k != superpixels.end() && *k < end;
           ++k) {
        rankings[*k].Offer(static_cast<int>(p), planes[p].scores[*k]);
      }
    }
  };
  // Each part is looked up in the lists of all planes.
  constexpr int kPartSize = 512;
  threads.Run(
      (num_superpixels + kPartSize - 1) / kPartSize,
      [&](int64_t begin, int64_t end) {
        rank(static_cast<int>(begin) * kPartSize,
             std::min(static_cast<int>(end) * kPartSize, num_superpixels));
      });
  return rankings;
}

std::vector<std::vector<int>> AssignedSuperpixels(
    const std::vector<Ranking>& rankings, size_t num_planes) {
  std::vector<std::vector<int>> members(num_planes);
  for (size_t k = 0; k < rankings.size(); ++k) {
    if (rankings[k].planes[0] >= 0) {
      members[rankings[k].planes[0]].push_back(static_cast<int>(k));
    }
  }
  return members;
}

std::vector<double> Supports(const std::vector<Ranking>& rankings,
                             size_t num_planes) {
  std::vector<double> supports(num_planes, 0.0);
  for (const Ranking& ranking : rankings) {
    if (ranking.planes[0] >= 0) {
      supports[ranking.planes[0]] += ranking.scores[0];
    }
  }
  return supports;
}

}  // namespace tsar
