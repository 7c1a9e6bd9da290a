// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/curved_surfaces.h"

#include "colmap_tsar/scene/surfaces/grow_surface.h"
#include "colmap_tsar/scene/surfaces/surface_costs.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace tsar {
namespace {

// Superpixels without a plane or next to another one: the interior of planes is
// left alone. Those with the largest residuals come first.
std::vector<int> Seeds(const SurfaceCosts& costs) {
  std::vector<int> seeds;
  for (int s = 0; s < costs.Count(); ++s) {
    const Superpixel& superpixel = costs.At(s);
    const bool is_interior = std::ranges::all_of(
        superpixel.neighbors,
        [&](int t) { return costs.LabelOf(t) == costs.LabelOf(s); });
    if (superpixel.IsMeasured() && (costs.LabelOf(s) < 0 || !is_interior)) {
      seeds.push_back(s);
    }
  }
  std::ranges::stable_sort(
      seeds, std::greater{}, [&](int s) { return costs.At(s).residual; });
  return seeds;
}

// The grown surfaces in the order of decreasing gain.
std::vector<GrownSurface> Candidates(const SurfaceCosts& costs,
                                     SurfaceGrower* grower) {
  std::vector<GrownSurface> candidates;
  std::vector<char> is_covered(costs.Count(), 0);
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
  std::ranges::stable_sort(candidates, std::greater{}, &GrownSurface::gain);
  return candidates;
}

}  // namespace

CurvedView FindCurvedSurfaces(const std::vector<ObservedView>& views,
                              const LabeledView& labeled,
                              const CurvedSurfaceOptions& options) {
  const SurfaceCosts costs(views, labeled, options);
  SurfaceGrower grower(costs);
  CurvedView result;
  result.labels.assign(costs.Count(), -1);
  result.evidence = labeled.evidence;
  for (GrownSurface& grown : Candidates(costs, &grower)) {
    if (std::ranges::any_of(grown.members,
                            [&](int s) { return grower.IsTaken(s); })) {
      grown = grower.Grow(grown.seed);
    }
    if (!(grown.gain > 0.0)) {
      continue;
    }
    grower.FillBetween(&grown);
    grower.Take(grown.members);
    const CurvedSurface& surface = grown.fitted.surface;
    for (const int s : grown.members) {
      result.labels[s] = static_cast<int>(result.surfaces.size());
      result.evidence[s] = costs.EvidenceOf(costs.At(s), surface);
    }
    result.surfaces.push_back(surface);
  }
  return result;
}

}  // namespace tsar
