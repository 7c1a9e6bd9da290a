// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/lazy_greedy_selection.h"

#include "colmap_tsar/device/parallel_for_teams.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>

namespace tsar {
namespace {

// Candidates whose gains are computed at a time.
constexpr int kGainBatch = 64;

// By how much a candidate would raise the best scores.
struct GainKernel {
  const float* scores;
  int num_superpixels;
  const float* best;
  const int* candidates;
  float* gains;

  template <typename Team>
  TSAR_HD void operator()(const Team& team, int64_t item) const {
    const float* own =
        scores + static_cast<int64_t>(candidates[item]) * num_superpixels;
    const float gain = team.template Accumulate<float>(
        num_superpixels, [&](int i, float* sum) {
          const float difference = own[i] - best[i];
          *sum += difference > 0.f ? difference : 0.f;
        });
    if (team.IsLeader()) {
      gains[item] = gain;
    }
  }
};

}  // namespace

LazyGreedySelection::LazyGreedySelection(
    const std::vector<WorldPlane>& candidates,
    const PlaneScorer& scorer,
    Device& device)
    : num_superpixels_(scorer.NumSuperpixels()),
      device_(&device),
      scores_(scorer.Score(candidates)),
      best_(device, num_superpixels_),
      gains_(candidates.size(), std::numeric_limits<float>::infinity()),
      order_(candidates.size()) {
  std::iota(order_.begin(), order_.end(), 0);
}

std::vector<float> LazyGreedySelection::Scores(int candidate) const {
  std::vector<float> scores(num_superpixels_);
  device_->CopyToHost(
      scores.data(),
      scores_.Data() + static_cast<size_t>(candidate) * num_superpixels_,
      scores.size() * sizeof(float));
  return scores;
}

LazyGreedySelection::Choice LazyGreedySelection::Next(
    const std::vector<float>& best) {
  // No gain is above what it was, also as computed, since rounding keeps the
  // order of numbers: once a gain exceeds the old ones of all candidates that
  // are left, these need not be computed anew.
  best_.Upload(best.data());
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    return gains_[a] != gains_[b] ? gains_[a] > gains_[b] : a < b;
  });
  Choice choice;
  for (size_t begin = 0;
       begin < order_.size() && gains_[order_[begin]] >= choice.gain;
       begin += kGainBatch) {
    const size_t end = std::min(begin + kGainBatch, order_.size());
    UpdateGains({order_.begin() + begin, order_.begin() + end});
    for (size_t i = begin; i < end; ++i) {
      const int candidate = order_[i];
      if (gains_[candidate] > choice.gain ||
          (gains_[candidate] == choice.gain && candidate < choice.candidate)) {
        choice = {candidate, gains_[candidate]};
      }
    }
  }
  return choice;
}

void LazyGreedySelection::UpdateGains(const std::vector<int>& candidates) {
  const Buffer<int> device_candidates(*device_, candidates);
  Buffer<float> device_gains(*device_, candidates.size());
  ParallelForTeams<128>(*device_,
                        static_cast<int64_t>(candidates.size()),
                        GainKernel{scores_.Data(),
                                   num_superpixels_,
                                   best_.Data(),
                                   device_candidates.Data(),
                                   device_gains.Data()});
  const std::vector<float> gains = device_gains.ToHost();
  for (size_t i = 0; i < candidates.size(); ++i) {
    gains_[candidates[i]] = gains[i];
  }
}

}  // namespace tsar
