// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/plane_ranking.h"

#include <cstddef>
#include <utility>

namespace tsar {

void Ranking::Offer(int plane, float score) {
  for (int i = 0; i < 3; ++i) {
    // Of equal ones, the first is in front.
    if (score > scores[i] || (score == scores[i] && plane < planes[i])) {
      std::swap(plane, planes[i]);
      std::swap(score, scores[i]);
    }
  }
}

bool Ranking::ChangeScore(int plane, float score) {
  const bool is_safe = score > scores[2];
  int place = 0;
  while (place < 3 && planes[place] != plane) {
    ++place;
  }
  if (place == 3) {
    Offer(plane, score);
    return true;
  }
  for (; place < 2; ++place) {
    planes[place] = planes[place + 1];
    scores[place] = scores[place + 1];
  }
  planes[2] = -1;
  scores[2] = 0.f;
  Offer(plane, score);
  return is_safe;
}

std::vector<Ranking> Rank(const std::vector<ScoredPlane>& planes,
                          int num_superpixels) {
  std::vector<Ranking> rankings(num_superpixels);
  for (size_t p = 0; p < planes.size(); ++p) {
    for (const int k : planes[p].superpixels) {
      rankings[k].Offer(static_cast<int>(p), planes[p].scores[k]);
    }
  }
  return rankings;
}

void UpdateRankings(const std::vector<ScoredPlane>& planes,
                    int changed,
                    const ScoredPlane& before,
                    std::vector<Ranking>* rankings) {
  const ScoredPlane& plane = planes[changed];
  const auto update = [&](int k) {
    Ranking& ranking = (*rankings)[k];
    if (!ranking.ChangeScore(changed, plane.scores[k])) {
      ranking = {};
      for (size_t p = 0; p < planes.size(); ++p) {
        ranking.Offer(static_cast<int>(p), planes[p].scores[k]);
      }
    }
  };
  for (const int k : before.superpixels) {
    update(k);
  }
  for (const int k : plane.superpixels) {
    if (!(before.scores[k] > 0.f)) {
      update(k);
    }
  }
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

}  // namespace tsar
