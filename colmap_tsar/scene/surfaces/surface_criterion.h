// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/surfaces/fit_curved_surface.h"
#include "colmap_tsar/scene/surfaces/surface_costs.h"

#include <cstddef>
#include <vector>

// The conditions under which a curved surface replaces the planes of its
// superpixels ("members" below): the Bayesian information criterion, in the
// units of costs, and tests of the fit. residuals, surface_costs: of each
// member on the surface.
namespace tsar {

// The cost of the three parameters of a plane, which a surface saves where it
// replaces a plane altogether.
double CostOfPlane(const SurfaceCosts& costs, const std::vector<int>& members);

// Whether num_superpixels is the number of all measured superpixels of a plane.
bool IsWholePlane(const SurfaceCosts& costs, int plane, size_t num_superpixels);

// Whether the surface explains its members better than their present labels.
bool Improves(const SurfaceCosts& costs,
              const std::vector<int>& members,
              const std::vector<float>& residuals);

// Whether the surface explains its members better than the planes in and around
// them do, each sample at the nearest one.
bool BeatsPlanesAround(const SurfaceCosts& costs,
                       const std::vector<int>& members,
                       const std::vector<float>& residuals);

// Whether the surface fits its members, is known there and not bent too much.
bool IsSound(const SurfaceCosts& costs,
             const FittedSurface& fitted,
             const std::vector<int>& members,
             const std::vector<float>& residuals);

// The decrease of the criterion less min_gain, in the units of costs.
double CriterionGain(const SurfaceCosts& costs,
                     const std::vector<int>& members,
                     const std::vector<float>& surface_costs);

}  // namespace tsar
