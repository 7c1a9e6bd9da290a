// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/surfaces/fit_curved_surface.h"
#include "colmap_tsar/scene/surfaces/surface_costs.h"

#include <cstddef>
#include <vector>

// When a curved surface is better than the planes of its superpixels ("members"
// below): the Bayesian information criterion, in the units of costs, and what
// else it must satisfy. residuals, surface_costs: of each member on the
// surface.
namespace tsar {

// What the three parameters of a plane cost: a surface saves them where it
// replaces a plane altogether.
double CostOfPlane(const SurfaceCosts& costs, const std::vector<int>& members);

// Whether so many superpixels of a plane are all of those that were measured.
bool IsWhole(const SurfaceCosts& costs, int plane, size_t num_superpixels);

// Whether the surface explains its members better than what they have.
bool Improves(const SurfaceCosts& costs,
              const std::vector<int>& members,
              const std::vector<float>& residuals);

// Whether the surface explains its members better than planes do, each sample
// on the nearest of those in and around them.
bool BeatsPlanesAround(const SurfaceCosts& costs,
                       const std::vector<int>& members,
                       const std::vector<float>& residuals);

// Whether it fits, is known where it lies and does not bend too much.
bool IsSound(const SurfaceCosts& costs,
             const FittedSurface& fitted,
             const std::vector<int>& members,
             const std::vector<float>& residuals);

// By how much the criterion falls beyond the least.
double CriterionGain(const SurfaceCosts& costs,
                     const std::vector<int>& members,
                     const std::vector<float>& surface_costs);

}  // namespace tsar
