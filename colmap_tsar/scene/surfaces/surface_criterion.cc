// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/surface_criterion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

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

// The planes of superpixels and of their neighbors, ascending.
std::vector<int> PlanesAround(const SurfaceCosts& costs,
                              const std::vector<int>& superpixels) {
  std::vector<char> is_around(static_cast<size_t>(costs.NumPlanes()), 0);
  const auto add = [&](int s) {
    if (costs.LabelOf(s) >= 0) {
      is_around[costs.LabelOf(s)] = 1;
    }
  };
  for (const int s : superpixels) {
    add(s);
    for (const int t : costs.At(s).neighbors) {
      add(t);
    }
  }
  std::vector<int> planes;
  for (int k = 0; k < costs.NumPlanes(); ++k) {
    if (is_around[k]) {
      planes.push_back(k);
    }
  }
  return planes;
}

}  // namespace

double CostOfPlane(const SurfaceCosts& costs, const std::vector<int>& members) {
  return kNumParametersOfPlane * CostOfParameter(costs, members);
}

bool IsWhole(const SurfaceCosts& costs, int plane, size_t num_superpixels) {
  return num_superpixels > 0 &&
         num_superpixels == static_cast<size_t>(costs.NumMeasured(plane));
}

bool Improves(const SurfaceCosts& costs,
              const std::vector<int>& members,
              const std::vector<float>& residuals) {
  double fall = 0.0;
  double weight = 0.0;
  for (size_t i = 0; i < members.size(); ++i) {
    const Superpixel& superpixel = costs.At(members[i]);
    fall += superpixel.weight * (superpixel.residual - residuals[i]);
    weight += superpixel.weight;
  }
  return fall > costs.Options().min_improvement * weight;
}

bool BeatsPlanesAround(const SurfaceCosts& costs,
                       const std::vector<int>& members,
                       const std::vector<float>& residuals) {
  const std::vector<int> planes = PlanesAround(costs, members);
  double fall = 0.0;
  double weight = 0.0;
  for (size_t i = 0; i < members.size(); ++i) {
    const int s = members[i];
    fall += costs.At(s).weight *
            (costs.ResidualOfNearest(s, planes) - residuals[i]);
    weight += costs.At(s).weight;
  }
  return fall >= costs.Options().min_improvement * weight;
}

bool IsSound(const SurfaceCosts& costs,
             const FittedSurface& fitted,
             const std::vector<int>& members,
             const std::vector<float>& residuals) {
  double residual = 0.0;
  double weight = 0.0;
  for (size_t i = 0; i < members.size(); ++i) {
    residual += costs.At(members[i]).weight * residuals[i];
    weight += costs.At(members[i]).weight;
  }
  const float* c = fitted.surface.coefficients;
  const float sagitta =
      (std::abs(c[3]) + std::abs(c[4]) + std::abs(c[5])) / c[0];
  return residual <= costs.Options().max_residual * weight &&
         BeatsPlanesAround(costs, members, residuals) && c[0] > 0.f &&
         sagitta <= costs.Options().max_sagitta &&
         std::all_of(members.begin(), members.end(), [&](int s) {
           return IsKnown(fitted, costs, costs.At(s));
         });
}

double CriterionGain(const SurfaceCosts& costs,
                     const std::vector<int>& members,
                     const std::vector<float>& surface_costs) {
  const double cost_of_parameter = CostOfParameter(costs, members);
  double loss = 0.0;
  std::vector<size_t> num_of_plane(static_cast<size_t>(costs.NumPlanes()), 0);
  for (size_t i = 0; i < members.size(); ++i) {
    const int s = members[i];
    loss += static_cast<double>(surface_costs[i]) - costs.PresentCost(s);
    if (costs.LabelOf(s) >= 0) {
      ++num_of_plane[costs.LabelOf(s)];
    }
  }
  double gain = -loss - FittedSurface::kNumParameters * cost_of_parameter -
                ToCost(costs, costs.Options().min_gain);
  for (int k = 0; k < costs.NumPlanes(); ++k) {
    if (IsWhole(costs, k, num_of_plane[k])) {
      gain += kNumParametersOfPlane * cost_of_parameter;
    }
  }
  return gain;
}

}  // namespace tsar
