// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/planes/world_plane.h"
#include "colmap_tsar/scene_planes/plane_scores.h"

#include <cstdint>
#include <vector>

namespace tsar {

// Greedy choice among candidate planes: finds the one that raises the best
// scores of the superpixels most. Lazy: a candidate's gain never grows, so that
// an old one is a bound, and most are never computed anew.
class LazyGreedySelection {
 public:
  struct Choice {
    int candidate = -1;  // -1 where none gains anything.
    float gain = 0.f;
  };

  LazyGreedySelection(const std::vector<WorldPlane>& candidates,
                      const PlaneScorer& scorer,
                      Device& device);

  // The score of a candidate for each superpixel.
  std::vector<float> Scores(int candidate) const;

  // best: the score of each superpixel's best plane so far; none may be below
  // that of the call before. Of equal candidates the first wins.
  Choice Next(const std::vector<float>& best);

 private:
  void UpdateGains(const std::vector<int>& candidates);

  int num_superpixels_;
  Device* device_;
  Buffer<float> scores_;
  Buffer<float> best_;
  std::vector<float> gains_;  // At the time when each was computed last.
  std::vector<int> order_;
};

}  // namespace tsar
