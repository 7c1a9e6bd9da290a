// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/surface_criterion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <set>

namespace tsar {
namespace {

constexpr int kNumParametersOfPlane = 3;

// A difference of the criterion, in the units of costs.
double ToCost(const SurfaceCosts& costs, double criterion) {
  const CurvedSurfaceOptions& options = costs.Options();
  return criterion * options.noise_share * options.noise_share *
         options.pixels_per_observation;
}

double CostOfParameter(const SurfaceCosts& costs,
                       const std::vector<int>& members) {
  double weight = 0.0;
  for (const int s : members) {
    weight += costs.At(s).weight;
  }
  return ToCost(
      costs,
      std::log(std::max(weight / costs.Options().pixels_per_observation, 2.0)));
}

// The planes of superpixels and of their neighbours.
std::vector<CurvedSurface> PlanesAround(const SurfaceCosts& costs,
                                        const std::vector<int>& superpixels) {
  std::set<int> labels;
  for (const int s : superpixels) {
    labels.insert(costs.LabelOf(s));
    for (const int t : costs.At(s).neighbors) {
      labels.insert(costs.LabelOf(t));
    }
  }
  labels.erase(-1);
  std::vector<CurvedSurface> planes;
  for (const int label : labels) {
    planes.push_back(costs.PlaneSurface(label));
  }
  return planes;
}

}  // namespace

double CostIncrease(const SurfaceCosts& costs,
                    const CurvedSurface& surface,
                    const std::vector<int>& superpixels) {
  double loss = 0.0;
  for (const int s : superpixels) {
    loss += static_cast<double>(costs.Cost(costs.At(s), surface)) -
            costs.At(s).cost;
  }
  return loss;
}

double CostOfPlane(const SurfaceCosts& costs, const std::vector<int>& members) {
  return kNumParametersOfPlane * CostOfParameter(costs, members);
}

bool IsWhole(const SurfaceCosts& costs,
             int plane,
             const std::vector<int>& superpixels) {
  size_t count = 0;
  for (int s = 0; s < costs.Count(); ++s) {
    count += costs.LabelOf(s) == plane && costs.At(s).IsMeasured() ? 1u : 0u;
  }
  return count > 0 && superpixels.size() == count;
}

bool Improves(const SurfaceCosts& costs,
              const CurvedSurface& surface,
              const std::vector<int>& members) {
  double fall = 0.0;
  double weight = 0.0;
  for (const int s : members) {
    const Superpixel& superpixel = costs.At(s);
    fall += superpixel.weight *
            (superpixel.residual - costs.Residual(superpixel, surface));
    weight += superpixel.weight;
  }
  return fall > costs.Options().min_improvement * weight;
}

bool BeatsPlanesAround(const SurfaceCosts& costs,
                       const CurvedSurface& surface,
                       const std::vector<int>& members) {
  const std::vector<CurvedSurface> planes = PlanesAround(costs, members);
  double fall = 0.0;
  double weight = 0.0;
  for (const int s : members) {
    fall += costs.At(s).weight * (costs.ResidualOfNearest(costs.At(s), planes) -
                                  costs.Residual(costs.At(s), surface));
    weight += costs.At(s).weight;
  }
  return fall >= costs.Options().min_improvement * weight;
}

bool IsSound(const SurfaceCosts& costs,
             const FittedSurface& fitted,
             const std::vector<int>& members) {
  double residual = 0.0;
  double weight = 0.0;
  for (const int s : members) {
    residual +=
        costs.At(s).weight * costs.Residual(costs.At(s), fitted.surface);
    weight += costs.At(s).weight;
  }
  const float* c = fitted.surface.coefficients;
  const float sagitta =
      (std::abs(c[3]) + std::abs(c[4]) + std::abs(c[5])) / c[0];
  return residual <= costs.Options().max_residual * weight &&
         BeatsPlanesAround(costs, fitted.surface, members) && c[0] > 0.f &&
         sagitta <= costs.Options().max_sagitta &&
         std::all_of(members.begin(), members.end(), [&](int s) {
           return IsKnown(fitted, costs, costs.At(s));
         });
}

double CriterionGain(const SurfaceCosts& costs,
                     const CurvedSurface& surface,
                     const std::vector<int>& members) {
  const double cost_of_parameter = CostOfParameter(costs, members);
  double gain = -CostIncrease(costs, surface, members) -
                FittedSurface::kNumParameters * cost_of_parameter -
                ToCost(costs, costs.Options().min_gain);
  for (int k = 0; k < costs.NumPlanes(); ++k) {
    std::vector<int> of_plane;
    std::copy_if(members.begin(),
                 members.end(),
                 std::back_inserter(of_plane),
                 [&](int s) { return costs.LabelOf(s) == k; });
    if (IsWhole(costs, k, of_plane)) {
      gain += kNumParametersOfPlane * cost_of_parameter;
    }
  }
  return gain;
}

}  // namespace tsar
