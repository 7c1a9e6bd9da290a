// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/curved_surface.h"
#include "colmap_tsar/scene/surfaces/surface_costs.h"

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// A curved surface fitted to the observations of superpixels.
struct FittedSurface {
  static constexpr int kNumParameters = 6;
  using Covariance = Eigen::Matrix<double, kNumParameters, kNumParameters>;

  CurvedSurface surface;
  Covariance covariance = Covariance::Zero();  // Of coefficients.
  // The range of its inlier depths.
  float min_depth = 0.f;
  float max_depth = 0.f;
};

// Fits a surface by least squares of the inverse depth with Cauchy weights.
// Nothing where the superpixels do not determine a surface. members:
// superpixels of `costs`. residuals: of the members on the surface.
std::optional<FittedSurface> FitCurvedSurface(const SurfaceCosts& costs,
                                              const std::vector<int>& members,
                                              std::vector<float>* residuals);

// Whether the surface's depth at a superpixel's pixels is known and possible.
bool IsKnown(const FittedSurface& fitted,
             const SurfaceCosts& costs,
             const Superpixel& superpixel);

}  // namespace tsar
