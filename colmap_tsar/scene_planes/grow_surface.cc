// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/grow_surface.h"

#include "colmap_tsar/scene_planes/direction_sectors.h"
#include "colmap_tsar/scene_planes/surface_criterion.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <utility>

namespace tsar {
namespace {

// A surface grows by one ring of superpixels at a time.
constexpr int kMaxRounds = 24;
// In so many it must explain what it covers better than the planes around, and
// later better than what each superpixel has: most seeds lie at the rims of
// walls, all over which it would grow else.
constexpr int kFirstRounds = 2;

}  // namespace

SurfaceGrower::SurfaceGrower(const SurfaceCosts& costs)
    : costs_(costs), taken_(static_cast<size_t>(costs.Count()), 0) {}

void SurfaceGrower::Take(const std::vector<int>& superpixels) {
  for (const int s : superpixels) {
    taken_[static_cast<size_t>(s)] = 1;
  }
}

GrownSurface SurfaceGrower::Grow(int seed) const {
  GrownSurface grown;
  grown.seed = seed;
  if (IsTaken(seed)) {
    return grown;
  }
  std::vector<int>& members = grown.members;
  members = {seed};
  for (const int s : costs_.At(seed).neighbors) {
    if (costs_.At(s).IsMeasured() && !IsTaken(s)) {
      members.push_back(s);
    }
  }
  std::sort(members.begin(), members.end());
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::optional<FittedSurface> fitted =
        FitCurvedSurface(costs_, members);
    if (!fitted || (round < kFirstRounds
                        ? !BeatsPlanesAround(costs_, fitted->surface, members)
                        : !Improves(costs_, fitted->surface, members))) {
      return grown;
    }
    std::vector<int> next = Connected(seed, *fitted, members);
    if (next == members) {
      break;
    }
    if (next.empty()) {
      return grown;
    }
    members = std::move(next);
  }
  const std::optional<FittedSurface> fitted = FitCurvedSurface(costs_, members);
  if (!fitted) {
    return grown;
  }
  std::vector<int> kept = Keep(*fitted, members);
  if (static_cast<int>(kept.size()) < costs_.Options().min_superpixels) {
    return grown;
  }
  members = std::move(kept);
  const std::optional<FittedSurface> refitted =
      FitCurvedSurface(costs_, members);
  if (refitted && IsSound(costs_, *refitted, members)) {
    grown.fitted = *refitted;
    grown.gain = CriterionGain(costs_, refitted->surface, members);
  }
  return grown;
}

// The measured superpixels that the surface explains about as well as what
// they have, as far as they hang together with the seed, one ring around the
// present ones at most.
std::vector<int> SurfaceGrower::Connected(
    int seed,
    const FittedSurface& fitted,
    const std::vector<int>& members) const {
  const auto holds = [&](int s) {
    const Superpixel& superpixel = costs_.At(s);
    return superpixel.IsMeasured() && !IsTaken(s) &&
           costs_.Residual(superpixel, fitted.surface) <=
               costs_.Options().max_residual_of_superpixel &&
           IsKnown(fitted, costs_, superpixel) &&
           costs_.Cost(superpixel, fitted.surface) <=
               superpixel.cost +
                   costs_.Options().growth_slack * superpixel.weight;
  };
  std::vector<char> is_member(static_cast<size_t>(costs_.Count()), 0);
  for (const int s : members) {
    is_member[static_cast<size_t>(s)] = 1;
  }
  std::vector<char> is_seen(static_cast<size_t>(costs_.Count()), 0);
  std::vector<int> result;
  if (!holds(seed)) {
    return result;
  }
  result.push_back(seed);
  is_seen[static_cast<size_t>(seed)] = 1;
  for (size_t i = 0; i < result.size(); ++i) {
    const int s = result[i];
    // The ring does not grow further.
    if (!is_member[static_cast<size_t>(s)]) {
      continue;
    }
    for (const int t : costs_.At(s).neighbors) {
      char& seen = is_seen[static_cast<size_t>(t)];
      if (!seen) {
        seen = 1;
        if (holds(t)) {
          result.push_back(t);
        }
      }
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

// Of the members with each plane those that the surface explains better, or
// all where none of the plane is left then, and it pays.
std::vector<int> SurfaceGrower::Keep(const FittedSurface& fitted,
                                     const std::vector<int>& members) const {
  const double saving = CostOfPlane(costs_, members);
  std::vector<int> kept;
  for (int k = -1; k < costs_.NumPlanes(); ++k) {
    std::vector<int> all;
    std::vector<int> better;
    for (const int s : members) {
      if (costs_.LabelOf(s) == k) {
        all.push_back(s);
        if (costs_.Cost(costs_.At(s), fitted.surface) < costs_.At(s).cost) {
          better.push_back(s);
        }
      }
    }
    const bool pays = k >= 0 && IsWhole(costs_, k, all) &&
                      CostIncrease(costs_, fitted.surface, all) - saving <
                          CostIncrease(costs_, fitted.surface, better);
    const std::vector<int>& chosen = pays ? all : better;
    kept.insert(kept.end(), chosen.begin(), chosen.end());
  }
  std::sort(kept.begin(), kept.end());
  return Largest(kept);
}

// The largest connected part.
std::vector<int> SurfaceGrower::Largest(
    const std::vector<int>& superpixels) const {
  std::vector<char> is_left(static_cast<size_t>(costs_.Count()), 0);
  for (const int s : superpixels) {
    is_left[static_cast<size_t>(s)] = 1;
  }
  std::vector<int> largest;
  for (const int seed : superpixels) {
    if (!is_left[static_cast<size_t>(seed)]) {
      continue;
    }
    std::vector<int> part = {seed};
    is_left[static_cast<size_t>(seed)] = 0;
    for (size_t i = 0; i < part.size(); ++i) {
      for (const int t : costs_.At(part[i]).neighbors) {
        if (is_left[static_cast<size_t>(t)]) {
          is_left[static_cast<size_t>(t)] = 0;
          part.push_back(t);
        }
      }
    }
    if (part.size() > largest.size()) {
      largest = std::move(part);
    }
  }
  std::sort(largest.begin(), largest.end());
  return largest;
}

void SurfaceGrower::FillBetween(GrownSurface* surface) const {
  const FittedSurface& fitted = surface->fitted;
  const std::vector<int> measured = surface->members;
  std::vector<char> is_seen(static_cast<size_t>(costs_.Count()), 0);
  for (const int s : measured) {
    is_seen[static_cast<size_t>(s)] = 1;
  }
  std::set<int> replaced;
  for (const int s : measured) {
    replaced.insert(costs_.LabelOf(s));
  }
  std::vector<int>& members = surface->members;
  for (size_t i = 0; i < members.size(); ++i) {
    // Not a reference: the list grows.
    const int s = members[i];
    for (const int t : costs_.At(s).neighbors) {
      char& seen = is_seen[static_cast<size_t>(t)];
      if (seen) {
        continue;
      }
      seen = 1;
      if (!costs_.At(t).IsMeasured() && !IsTaken(t) &&
          (costs_.LabelOf(t) < 0 ? !costs_.OpposesRegion(t, fitted.surface)
                                 : replaced.count(costs_.LabelOf(t)) > 0) &&
          IsSurrounded(costs_.At(t), measured) &&
          IsKnown(fitted, costs_, costs_.At(t)) &&
          costs_.Cost(costs_.At(t), fitted.surface) <= costs_.At(t).cost) {
        members.push_back(t);
      }
    }
  }
  std::sort(members.begin(), members.end());
}

bool SurfaceGrower::IsSurrounded(const Superpixel& superpixel,
                                 const std::vector<int>& measured) const {
  DirectionSectors sectors;
  for (const int s : measured) {
    sectors.Add(costs_.At(s).middle.x - superpixel.middle.x,
                costs_.At(s).middle.y - superpixel.middle.y);
  }
  return sectors.Count() >= DirectionSectors::kNumKnown;
}

}  // namespace tsar
