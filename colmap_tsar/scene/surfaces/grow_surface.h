// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/surfaces/fit_curved_surface.h"
#include "colmap_tsar/scene/surfaces/surface_costs.h"

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace tsar {

// A surface that was fitted to connected superpixels, and its gain.
struct GrownSurface {
  int seed = 0;
  std::vector<int> members;  // Ascending.
  FittedSurface fitted;
  double gain = 0.0;  // In the units of costs; 0 where there is no surface.
};

// Grows surfaces around seeds, in superpixels that no other surface has taken.
class SurfaceGrower {
 public:
  // Keeps a reference to the costs.
  explicit SurfaceGrower(const SurfaceCosts& costs);

  bool IsTaken(int s) const { return taken_[s] != 0; }
  void Take(const std::vector<int>& superpixels);

  // Grows a surface. If it has no gain, its members are those last tried.
  GrownSurface Grow(int seed);

  // Adds superpixels without measurements that measured members surround,
  // unless their plane was carried there by other views.
  void FillBetween(GrownSurface* surface) const;

 private:
  // The surface of a set of superpixels and its tests, each computed on demand.
  // Most seeds on one object grow into the same superpixels, with the same
  // further growth.
  struct Trial {
    std::optional<FittedSurface> fitted;
    std::vector<float> residuals;  // Of members, if fitted.
    std::optional<bool> beats_planes_around;
    std::optional<bool> improves;
    // Results of Next(): each seed is in one of them at most.
    std::vector<std::vector<int>> parts;
    std::optional<GrownSurface> finished;
  };
  using Trials = std::map<std::vector<int>, Trial>;  // By members.

  Trials::value_type& Try(std::vector<int> members);
  bool IsBetter(int round, Trials::value_type* tried) const;
  std::vector<int> Next(int seed, Trials::value_type* tried) const;
  GrownSurface Finish(const Trials::value_type& tried);

  const SurfaceCosts& costs_;
  std::vector<char> taken_;
  Trials trials_;
};

}  // namespace tsar
