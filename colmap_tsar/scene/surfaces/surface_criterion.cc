// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/surface_criterion.h"

#include <algorithm>
#include <cmath>
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

double SumOfWeights(const SurfaceCosts& costs,
                    const std::vector<int>& members) {
  double weight = 0.0;
  for (const int s : members) {
    weight += costs.At(s).weight;
  }
  return weight;
}

double CostOfParameter(const SurfaceCosts& costs,
                       const std::vector<int>& members) {
  const double num_observations =
      SumOfWeights(costs, members) / costs.Options().pixels_per_observation;
  return ToCost(costs, std::log(std::max(num_observations, 2.0)));
}

// The planes of superpixels and of their neighbors, ascending.
std::vector<int> PlanesAround(const SurfaceCosts& costs,
                              const std::vector<int>& superpixels) {
  std::set<int> planes;
  for (const int s : superpixels) {
    planes.insert(costs.LabelOf(s));
    for (const int t : costs.At(s).neighbors) {
      planes.insert(costs.LabelOf(t));
    }
  }
  planes.erase(-1);
  return {planes.begin(), planes.end()};
}

// The weighted sum over members of how much less their residuals on the surface
// are than residual_before(member).
template <typename Function>
double Decrease(const SurfaceCosts& costs,
                const std::vector<int>& members,
                const std::vector<float>& residuals,
                const Function& residual_before) {
  double decrease = 0.0;
  for (size_t i = 0; i < members.size(); ++i) {
    decrease += costs.At(members[i]).weight *
                (residual_before(members[i]) - residuals[i]);
  }
  return decrease;
}

}  // namespace

double CostOfPlane(const SurfaceCosts& costs, const std::vector<int>& members) {
  return kNumParametersOfPlane * CostOfParameter(costs, members);
}

bool IsWholePlane(const SurfaceCosts& costs,
                  int plane,
                  size_t num_superpixels) {
  return num_superpixels > 0 &&
         num_superpixels == size_t(costs.NumMeasured(plane));
}

bool Improves(const SurfaceCosts& costs,
              const std::vector<int>& members,
              const std::vector<float>& residuals) {
  const auto present = [&](int s) { return costs.At(s).residual; };
  return Decrease(costs, members, residuals, present) >
         costs.Options().min_improvement * SumOfWeights(costs, members);
}

bool BeatsPlanesAround(const SurfaceCosts& costs,
                       const std::vector<int>& members,
                       const std::vector<float>& residuals) {
  const std::vector<int> planes = PlanesAround(costs, members);
  const auto of_nearest = [&](int s) {
    return costs.ResidualOfNearest(s, planes);
  };
  return Decrease(costs, members, residuals, of_nearest) >=
         costs.Options().min_improvement * SumOfWeights(costs, members);
}

bool IsSound(const SurfaceCosts& costs,
             const FittedSurface& fitted,
             const std::vector<int>& members,
             const std::vector<float>& residuals) {
  double residual = 0.0;
  for (size_t i = 0; i < members.size(); ++i) {
    residual += costs.At(members[i]).weight * residuals[i];
  }
  const float* c = fitted.surface.coefficients;
  const float sagitta =
      (std::abs(c[3]) + std::abs(c[4]) + std::abs(c[5])) / c[0];
  return residual <=
             costs.Options().max_residual * SumOfWeights(costs, members) &&
         BeatsPlanesAround(costs, members, residuals) && c[0] > 0.f &&
         sagitta <= costs.Options().max_sagitta &&
         std::ranges::all_of(members, [&](int s) {
           return IsKnown(fitted, costs, costs.At(s));
         });
}

double CriterionGain(const SurfaceCosts& costs,
                     const std::vector<int>& members,
                     const std::vector<float>& surface_costs) {
  const double cost_of_parameter = CostOfParameter(costs, members);
  double loss = 0.0;
  std::vector<size_t> num_of_plane(costs.NumPlanes(), 0);
  for (size_t i = 0; i < members.size(); ++i) {
    const int s = members[i];
    loss += double{surface_costs[i]} - costs.PresentCost(s);
    if (costs.LabelOf(s) >= 0) {
      ++num_of_plane[costs.LabelOf(s)];
    }
  }
  double gain = -loss - FittedSurface::kNumParameters * cost_of_parameter -
                ToCost(costs, costs.Options().min_gain);
  for (int k = 0; k < costs.NumPlanes(); ++k) {
    if (IsWholePlane(costs, k, num_of_plane[k])) {
      gain += kNumParametersOfPlane * cost_of_parameter;
    }
  }
  return gain;
}

}  // namespace tsar
