// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/thread_pool.h"
#include "colmap_tsar/scene/discovery/score_planes.h"

#include <algorithm>
#include <vector>

namespace tsar {

// The best three planes of a superpixel; -1 and 0 where there are fewer.
struct Ranking {
  int planes[3] = {-1, -1, -1};
  float scores[3] = {0.f, 0.f, 0.f};

  void Offer(int plane, float score);

  // The best score among all other planes.
  float BestWithout(int plane, int other_plane) const {
    int i = 0;
    while (i < 2 && (planes[i] == plane || planes[i] == other_plane)) {
      ++i;
    }
    return planes[i] == plane || planes[i] == other_plane ? 0.f : scores[i];
  }
};

std::vector<Ranking> Rank(const std::vector<ScoredPlane>& planes,
                          int num_superpixels,
                          ThreadPool& threads);

// The superpixels of each plane: each is assigned to its best plane.
std::vector<std::vector<int>> AssignedSuperpixels(
    const std::vector<Ranking>& rankings, size_t num_planes);

// The sum of the scores of the superpixels that are assigned to each plane.
std::vector<double> Supports(const std::vector<Ranking>& rankings,
                             size_t num_planes);

// The gain of a plane over best(superpixel), the best scores without it.
template <typename Function>
double PlaneGain(const ScoredPlane& plane, const Function& best) {
  double gain = 0.0;
  for (const int k : plane.superpixels) {
    gain += std::max(plane.scores[k] - best(k), 0.f);
  }
  return gain;
}

}  // namespace tsar
