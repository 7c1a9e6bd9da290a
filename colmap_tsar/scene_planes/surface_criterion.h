// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/curved_surface.h"
#include "colmap_tsar/scene_planes/fit_curved_surface.h"
#include "colmap_tsar/scene_planes/surface_costs.h"

#include <vector>

// When a curved surface is better than the planes of its superpixels ("members"
// below): the Bayesian information criterion, in the units of costs, and what
// else it must satisfy.
namespace tsar {

// How much worse the surface explains the superpixels than what they have.
double CostIncrease(const SurfaceCosts& costs,
                    const CurvedSurface& surface,
                    const std::vector<int>& superpixels);

// What the three parameters of a plane cost: a surface saves them where it
// replaces a plane altogether.
double CostOfPlane(const SurfaceCosts& costs, const std::vector<int>& members);

// Whether these are all the measured superpixels of a plane.
bool IsWhole(const SurfaceCosts& costs,
             int plane,
             const std::vector<int>& superpixels);

// Whether the surface explains its members better than what they have.
bool Improves(const SurfaceCosts& costs,
              const CurvedSurface& surface,
              const std::vector<int>& members);

// Whether the surface explains its members better than planes do, each
// observation on the nearest of those in and around them.
bool BeatsPlanesAround(const SurfaceCosts& costs,
                       const CurvedSurface& surface,
                       const std::vector<int>& members);

// Whether it fits, is known where it lies and does not bend too much.
bool IsSound(const SurfaceCosts& costs,
             const FittedSurface& fitted,
             const std::vector<int>& members);

// By how much the criterion falls beyond the least.
double CriterionGain(const SurfaceCosts& costs,
                     const CurvedSurface& surface,
                     const std::vector<int>& members);

}  // namespace tsar
