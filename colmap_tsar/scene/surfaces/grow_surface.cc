// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/grow_surface.h"

#include "colmap_tsar/scene/surfaces/direction_sectors.h"
#include "colmap_tsar/scene/surfaces/surface_criterion.h"

#include <algorithm>
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

// Adds the superpixels that are connected to some, as far as `joins` accepts
// them, which is asked once about each; only the neighbors of those are tried
// that `expands` accepts. Ascending.
template <typename Joins, typename Expands>
std::vector<int> AddConnected(const SurfaceCosts& costs,
                              std::vector<int> superpixels,
                              const Joins& joins,
                              const Expands& expands) {
  std::vector<char> is_seen(costs.Count(), 0);
  for (const int s : superpixels) {
    is_seen[s] = 1;
  }
  for (size_t i = 0; i < superpixels.size(); ++i) {
    const int s = superpixels[i];  // A copy, since the list grows.
    if (!expands(s)) {
      continue;
    }
    for (const int t : costs.At(s).neighbors) {
      if (is_seen[t] == 0) {
        is_seen[t] = 1;
        if (joins(t)) {
          superpixels.push_back(t);
        }
      }
    }
  }
  std::ranges::sort(superpixels);
  return superpixels;
}

bool Always(int) { return true; }

// The largest connected component.
std::vector<int> Largest(const SurfaceCosts& costs,
                         const std::vector<int>& superpixels) {
  std::set<int> left(superpixels.begin(), superpixels.end());
  std::vector<int> largest;
  for (const int seed : superpixels) {
    if (!left.contains(seed)) {
      continue;
    }
    std::vector<int> part = AddConnected(
        costs, {seed}, [&](int t) { return left.contains(t); }, Always);
    for (const int s : part) {
      left.erase(s);
    }
    if (part.size() > largest.size()) {
      largest = std::move(part);
    }
  }
  return largest;
}

// The cost of each member on a surface with these residuals.
std::vector<float> CostsOn(const SurfaceCosts& costs,
                           const std::vector<int>& members,
                           const std::vector<float>& residuals) {
  std::vector<float> result;
  for (size_t i = 0; i < members.size(); ++i) {
    result.push_back(costs.Cost(costs.At(members[i]), residuals[i]));
  }
  return result;
}

// For each plane, keeps its members that the surface explains better, or all
// where the surface then replaces the plane altogether at a lower cost; of
// these the largest component. surface_costs: of the members on the surface.
std::vector<int> Keep(const SurfaceCosts& costs,
                      const std::vector<int>& members,
                      const std::vector<float>& surface_costs) {
  struct Share {
    std::vector<int> members;
    double increase = 0.0;  // Of their costs.

    void Add(int s, double cost) {
      members.push_back(s);
      increase += cost;
    }
  };
  const double saving = CostOfPlane(costs, members);
  std::vector<int> kept;
  for (int k = -1; k < costs.NumPlanes(); ++k) {
    Share all;
    Share better;
    for (size_t i = 0; i < members.size(); ++i) {
      const int s = members[i];
      if (costs.LabelOf(s) != k) {
        continue;
      }
      const float present = costs.PresentCost(s);
      const double increase = double{surface_costs[i]} - present;
      all.Add(s, increase);
      if (surface_costs[i] < present) {
        better.Add(s, increase);
      }
    }
    const bool pays = k >= 0 && IsWholePlane(costs, k, all.members.size()) &&
                      all.increase - saving < better.increase;
    const std::vector<int>& chosen = pays ? all.members : better.members;
    kept.insert(kept.end(), chosen.begin(), chosen.end());
  }
  std::ranges::sort(kept);
  return Largest(costs, kept);
}

}  // namespace

SurfaceGrower::SurfaceGrower(const SurfaceCosts& costs)
    : costs_(costs), taken_(costs.Count(), 0) {}

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
  std::ranges::sort(members);
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

// The measured superpixels that the surface explains about as well as their
// present labels, as far as they are connected to the seed, which is a member;
// at most one ring around the present members. Cached: such a part is the same
// for each seed in it.
std::vector<int> SurfaceGrower::Next(int seed,
                                     Trials::value_type* tried) const {
  auto& [members, trial] = *tried;
  const auto found = std::ranges::find_if(trial.parts, [&](const auto& part) {
    return std::ranges::binary_search(part, seed);
  });
  if (found != trial.parts.end()) {
    return *found;
  }
  const FittedSurface& fitted = *trial.fitted;
  std::vector<std::optional<float>> residuals(costs_.Count());  // Of members.
  for (size_t i = 0; i < members.size(); ++i) {
    residuals[members[i]] = trial.residuals[i];
  }
  const auto holds = [&](int s) {
    const Superpixel& superpixel = costs_.At(s);
    if (!superpixel.IsMeasured() || IsTaken(s)) {
      return false;
    }
    const float residual =
        residuals[s] ? *residuals[s]
                     : costs_.Measure(superpixel, fitted.surface).residual;
    return residual <= costs_.Options().max_residual_of_superpixel &&
           IsKnown(fitted, costs_, superpixel) &&
           costs_.Cost(superpixel, residual) <=
               costs_.PresentCost(s) +
                   costs_.Options().growth_slack * superpixel.weight;
  };
  if (!holds(seed)) {
    return {};
  }
  // Superpixels of the ring are not expanded.
  return trial.parts.emplace_back(AddConnected(
      costs_, {seed}, holds, [&](int s) { return residuals[s].has_value(); }));
}

GrownSurface SurfaceGrower::Finish(const Trials::value_type& tried) {
  const auto& [members, trial] = tried;
  GrownSurface grown;
  grown.members = members;
  if (!trial.fitted) {
    return grown;
  }
  std::vector<int> kept =
      Keep(costs_, members, CostsOn(costs_, members, trial.residuals));
  if (static_cast<int>(kept.size()) < costs_.Options().min_superpixels) {
    return grown;
  }
  const auto& [refitted_members, refitted] = Try(std::move(kept));
  grown.members = refitted_members;
  if (refitted.fitted &&
      IsSound(costs_, *refitted.fitted, grown.members, refitted.residuals)) {
    grown.fitted = *refitted.fitted;
    grown.gain =
        CriterionGain(costs_,
                      grown.members,
                      CostsOn(costs_, grown.members, refitted.residuals));
  }
  return grown;
}

void SurfaceGrower::FillBetween(GrownSurface* surface) const {
  const FittedSurface& fitted = surface->fitted;
  std::set<int> replaced;  // The planes of members.
  std::vector<Vec3f> middles;
  for (const int s : surface->members) {
    replaced.insert(costs_.LabelOf(s));
    middles.push_back(costs_.MiddleOf(s));
  }
  const auto joins = [&](int t) {
    return !costs_.At(t).IsMeasured() && !IsTaken(t) &&
           (costs_.LabelOf(t) < 0 ? !costs_.OpposesRegion(t, fitted.surface)
                                  : replaced.contains(costs_.LabelOf(t))) &&
           IsSurrounded(costs_.MiddleOf(t), middles) &&
           IsKnown(fitted, costs_, costs_.At(t));
  };
  surface->members = AddConnected(costs_, surface->members, joins, Always);
}

}  // namespace tsar
