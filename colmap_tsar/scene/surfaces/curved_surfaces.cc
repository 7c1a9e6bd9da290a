// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/curved_surfaces.h"

#include "colmap_tsar/scene/surfaces/grow_surface.h"
#include "colmap_tsar/scene/surfaces/surface_costs.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace tsar {
namespace {

// Superpixels without a plane or next to another one: the interior of planes is
// left alone. Those with the largest residuals come first.
std::vector<int> Seeds(const SurfaceCosts& costs) {
  std::vector<int> seeds;
  for (int s = 0; s < costs.Count(); ++s) {
    const Superpixel& superpixel = costs.At(s);
    const bool is_alone = std::all_of(
        superpixel.neighbors.begin(), superpixel.neighbors.end(), [&](int t) {
          return costs.LabelOf(t) == costs.LabelOf(s);
        });
    if (superpixel.IsMeasured() && (costs.LabelOf(s) < 0 || !is_alone)) {
      seeds.push_back(s);
    }
  }
  std::stable_sort(seeds.begin(), seeds.end(), [&](int s, int t) {
    return costs.At(s).residual > costs.At(t).residual;
  });
  return seeds;
}

// The grown surfaces in the order of decreasing gain.
std::vector<GrownSurface> Candidates(const SurfaceCosts& costs,
                                     SurfaceGrower* grower) {
  std::vector<GrownSurface> candidates;
  std::vector<char> is_covered(static_cast<size_t>(costs.Count()), 0);
  for (const int seed : Seeds(costs)) {
    if (is_covered[seed]) {
      continue;
    }
    GrownSurface grown = grower->Grow(seed);
    if (grown.gain > 0.0) {
      for (const int s : grown.members) {
        is_covered[s] = 1;
      }
      candidates.push_back(std::move(grown));
    }
  }
  std::stable_sort(candidates.begin(),
                   candidates.end(),
                   [](const GrownSurface& a, const GrownSurface& b) {
                     return a.gain > b.gain;
                   });
  return candidates;
}

}  // namespace

CurvedView FindCurvedSurfaces(const std::vector<ObservedView>& views,
                              const LabeledView& labeled,
                              const CurvedSurfaceOptions& options) {
  const SurfaceCosts costs(views, labeled, options);
  SurfaceGrower grower(costs);
  CurvedView result;
  result.labels.assign(static_cast<size_t>(costs.Count()), -1);
  result.evidence = labeled.evidence;
  for (GrownSurface& grown : Candidates(costs, &grower)) {
    const bool is_touched =
        std::any_of(grown.members.begin(), grown.members.end(), [&](int s) {
          return grower.IsTaken(s);
        });
    if (is_touched) {
      grown = grower.Grow(grown.seed);
    }
    if (!(grown.gain > 0.0)) {
      continue;
    }
    grower.FillBetween(&grown);
    grower.Take(grown.members);
    const CurvedSurface& surface = grown.fitted.surface;
    for (const int s : grown.members) {
      const auto i = static_cast<size_t>(s);
      result.labels[i] = static_cast<int>(result.surfaces.size());
      result.evidence[i] = costs.EvidenceOf(costs.At(s), surface);
    }
    result.surfaces.push_back(surface);
  }
  return result;
}

}  // namespace tsar
