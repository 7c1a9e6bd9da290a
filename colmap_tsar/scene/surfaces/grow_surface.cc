// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/grow_surface.h"

#include "colmap_tsar/scene/surfaces/direction_sectors.h"
#include "colmap_tsar/scene/surfaces/surface_criterion.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

namespace tsar {
namespace {

// A surface grows by one ring of superpixels at a time.
constexpr int kMaxRounds = 24;
// In the first rounds it must explain its members better than the planes
// around, and later better than the present label of each: most seeds lie at
// the rims of walls, over which it would grow otherwise.
constexpr int kFirstRounds = 2;

// Whether there are measurements all around a point.
bool IsSurrounded(const Vec3f& middle, const std::vector<Vec3f>& measured) {
  DirectionSectors sectors;
  for (const Vec3f& other : measured) {
    sectors.Add(other.x - middle.x, other.y - middle.y);
  }
  return sectors.Count() >= DirectionSectors::kNumKnown;
}

}  // namespace

SurfaceGrower::SurfaceGrower(const SurfaceCosts& costs)
    : costs_(costs), taken_(static_cast<size_t>(costs.Count()), 0) {}

void SurfaceGrower::Take(const std::vector<int>& superpixels) {
  for (const int s : superpixels) {
    taken_[s] = 1;
  }
  for (auto& [members, trial] : trials_) {
    trial.parts.clear();
  }
}

GrownSurface SurfaceGrower::Grow(int seed) {
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
    Trials::value_type& tried = Try(members);
    if (!IsBetter(round, &tried)) {
      return grown;
    }
    std::vector<int> next = Next(seed, &tried);
    if (next == members) {
      break;
    }
    if (next.empty()) {
      return grown;
    }
    members = std::move(next);
  }
  Trials::value_type& tried = Try(members);
  if (!tried.second.finished) {
    tried.second.finished = Finish(tried);
  }
  grown = *tried.second.finished;
  grown.seed = seed;
  return grown;
}

SurfaceGrower::Trials::value_type& SurfaceGrower::Try(
    std::vector<int> members) {
  const auto [tried, is_new] = trials_.try_emplace(std::move(members));
  if (is_new) {
    Trial& trial = tried->second;
    trial.fitted = FitCurvedSurface(costs_, tried->first, &trial.residuals);
  }
  return *tried;
}

bool SurfaceGrower::IsBetter(int round, Trials::value_type* tried) const {
  auto& [members, trial] = *tried;
  if (!trial.fitted) {
    return false;
  }
  std::optional<bool>& is_better =
      round < kFirstRounds ? trial.beats_planes_around : trial.improves;
  if (!is_better) {
    is_better = round < kFirstRounds
                    ? BeatsPlanesAround(costs_, members, trial.residuals)
                    : Improves(costs_, members, trial.residuals);
  }
  return *is_better;
}

// Connected(), cached: a connected part is the same for each seed in it.
std::vector<int> SurfaceGrower::Next(int seed,
                                     Trials::value_type* tried) const {
  std::vector<std::vector<int>>& parts = tried->second.parts;
  const auto found =
      std::find_if(parts.begin(), parts.end(), [&](const auto& part) {
        return std::binary_search(part.begin(), part.end(), seed);
      });
  if (found != parts.end()) {
    return *found;
  }
  std::vector<int> part = Connected(seed, *tried);
  if (!part.empty()) {
    parts.push_back(part);
  }
  return part;
}

// The measured superpixels that the surface explains about as well as their
// present labels, as far as they are connected to the seed, which is a member;
// at most one ring around the present members.
std::vector<int> SurfaceGrower::Connected(
    int seed, const Trials::value_type& tried) const {
  const auto& [members, trial] = tried;
  const FittedSurface& fitted = *trial.fitted;
  std::vector<char> is_member(static_cast<size_t>(costs_.Count()), 0);
  std::vector<float> residuals(static_cast<size_t>(costs_.Count()));
  for (size_t i = 0; i < members.size(); ++i) {
    is_member[members[i]] = 1;
    residuals[members[i]] = trial.residuals[i];
  }
  const auto holds = [&](int s) {
    const Superpixel& superpixel = costs_.At(s);
    if (!superpixel.IsMeasured() || IsTaken(s)) {
      return false;
    }
    const float residual =
        is_member[s] ? residuals[s]
                     : costs_.Measure(superpixel, fitted.surface).residual;
    return residual <= costs_.Options().max_residual_of_superpixel &&
           IsKnown(fitted, costs_, superpixel) &&
           costs_.Cost(superpixel, residual) <=
               costs_.PresentCost(s) +
                   costs_.Options().growth_slack * superpixel.weight;
  };
  std::vector<char> is_seen(static_cast<size_t>(costs_.Count()), 0);
  std::vector<int> result;
  if (!holds(seed)) {
    return result;
  }
  result.push_back(seed);
  is_seen[seed] = 1;
  for (size_t i = 0; i < result.size(); ++i) {
    const int s = result[i];
    // Superpixels of the ring are not expanded.
    if (!is_member[s]) {
      continue;
    }
    for (const int t : costs_.At(s).neighbors) {
      char& seen = is_seen[t];
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

GrownSurface SurfaceGrower::Finish(const Trials::value_type& tried) {
  GrownSurface grown;
  grown.members = tried.first;
  if (!tried.second.fitted) {
    return grown;
  }
  std::vector<int> kept = Keep(tried.first, CostsOn(tried));
  if (static_cast<int>(kept.size()) < costs_.Options().min_superpixels) {
    return grown;
  }
  const Trials::value_type& refitted = Try(std::move(kept));
  grown.members = refitted.first;
  const Trial& trial = refitted.second;
  if (trial.fitted &&
      IsSound(costs_, *trial.fitted, grown.members, trial.residuals)) {
    grown.fitted = *trial.fitted;
    grown.gain = CriterionGain(costs_, grown.members, CostsOn(refitted));
  }
  return grown;
}

std::vector<float> SurfaceGrower::CostsOn(
    const Trials::value_type& tried) const {
  const auto& [members, trial] = tried;
  std::vector<float> costs;
  for (size_t i = 0; i < members.size(); ++i) {
    costs.push_back(costs_.Cost(costs_.At(members[i]), trial.residuals[i]));
  }
  return costs;
}

// For each plane, keeps its members that the surface explains better, or all
// where the surface then replaces the plane altogether at a lower cost. costs:
// of the members on the surface.
std::vector<int> SurfaceGrower::Keep(const std::vector<int>& members,
                                     const std::vector<float>& costs) const {
  struct Share {
    std::vector<int> members;
    double increase = 0.0;  // Of their costs.

    void Add(int s, double cost) {
      members.push_back(s);
      increase += cost;
    }
  };
  const double saving = CostOfPlane(costs_, members);
  std::vector<int> kept;
  for (int k = -1; k < costs_.NumPlanes(); ++k) {
    Share all;
    Share better;
    for (size_t i = 0; i < members.size(); ++i) {
      const int s = members[i];
      if (costs_.LabelOf(s) != k) {
        continue;
      }
      const float present = costs_.PresentCost(s);
      const double increase = static_cast<double>(costs[i]) - present;
      all.Add(s, increase);
      if (costs[i] < present) {
        better.Add(s, increase);
      }
    }
    const bool pays = k >= 0 && IsWhole(costs_, k, all.members.size()) &&
                      all.increase - saving < better.increase;
    const std::vector<int>& chosen = pays ? all.members : better.members;
    kept.insert(kept.end(), chosen.begin(), chosen.end());
  }
  std::sort(kept.begin(), kept.end());
  return Largest(kept);
}

// The largest connected component.
std::vector<int> SurfaceGrower::Largest(
    const std::vector<int>& superpixels) const {
  std::vector<char> is_left(static_cast<size_t>(costs_.Count()), 0);
  for (const int s : superpixels) {
    is_left[s] = 1;
  }
  std::vector<int> largest;
  for (const int seed : superpixels) {
    if (!is_left[seed]) {
      continue;
    }
    std::vector<int> part = {seed};
    is_left[seed] = 0;
    for (size_t i = 0; i < part.size(); ++i) {
      for (const int t : costs_.At(part[i]).neighbors) {
        if (is_left[t]) {
          is_left[t] = 0;
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
    is_seen[s] = 1;
  }
  std::set<int> replaced;
  for (const int s : measured) {
    replaced.insert(costs_.LabelOf(s));
  }
  std::vector<Vec3f> middles;
  for (const int s : measured) {
    middles.push_back(costs_.MiddleOf(s));
  }
  std::vector<int>& members = surface->members;
  for (size_t i = 0; i < members.size(); ++i) {
    // A copy, since the list grows.
    const int s = members[i];
    for (const int t : costs_.At(s).neighbors) {
      char& seen = is_seen[t];
      if (seen) {
        continue;
      }
      seen = 1;
      if (!costs_.At(t).IsMeasured() && !IsTaken(t) &&
          (costs_.LabelOf(t) < 0 ? !costs_.OpposesRegion(t, fitted.surface)
                                 : replaced.count(costs_.LabelOf(t)) > 0) &&
          IsSurrounded(costs_.MiddleOf(t), middles) &&
          IsKnown(fitted, costs_, costs_.At(t))) {
        members.push_back(t);
      }
    }
  }
  std::sort(members.begin(), members.end());
}

}  // namespace tsar
