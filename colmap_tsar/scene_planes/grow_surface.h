// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/fit_curved_surface.h"
#include "colmap_tsar/scene_planes/surface_costs.h"

#include <cstddef>
#include <vector>

namespace tsar {

// A surface that was fitted to connected superpixels, and what it gains.
struct GrownSurface {
  int seed = 0;
  std::vector<int> members;  // Ascending.
  FittedSurface fitted;
  double gain = 0.0;  // In the units of costs; 0 where there is no surface.
};

// Grows surfaces about superpixels, in those that no other surface has taken.
class SurfaceGrower {
 public:
  // Keeps a reference.
  explicit SurfaceGrower(const SurfaceCosts& costs);

  bool IsTaken(int s) const { return taken_[static_cast<size_t>(s)] != 0; }
  void Take(const std::vector<int>& superpixels);

  // The members of one without a gain are those that were tried.
  GrownSurface Grow(int seed) const;

  // Adds superpixels without measurements, but with measured members all
  // around, unless their plane was carried there by other views.
  void FillBetween(GrownSurface* surface) const;

 private:
  std::vector<int> Connected(int seed,
                             const FittedSurface& fitted,
                             const std::vector<int>& members) const;
  std::vector<int> Keep(const FittedSurface& fitted,
                        const std::vector<int>& members) const;
  std::vector<int> Largest(const std::vector<int>& superpixels) const;
  bool IsSurrounded(const Superpixel& superpixel,
                    const std::vector<int>& measured) const;

  const SurfaceCosts& costs_;
  std::vector<char> taken_;
};

}  // namespace tsar
