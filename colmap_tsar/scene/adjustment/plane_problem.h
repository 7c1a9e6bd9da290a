// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/adjustment/adjust_planes.h"

#include <vector>

#include <Eigen/Core>

namespace tsar {

// One adjustment of planes to measurements made at their current parameters.
struct PlaneProblem {
  PlaneAdjustment at;  // Valid; see AdjustPlanes.
  // For each plane the center of its rotation, on the plane or off it: amid its
  // measurements, the errors of rotation and shift are nearly independent.
  std::vector<Eigen::Vector3d> middles;
  std::vector<PlaneMeasurement> measurements;
  double size = 1.0;  // Size of the scene; above 0.
};

// Moves the planes and the frames of `at` to the best agreement with the
// measurements and angles; a prior keeps what these do not determine at its
// current value. Planes of a frame become aligned to it. Returns false if
// nothing moves.
bool SolvePlanes(PlaneProblem* problem);

// The current planes with their covariances.
std::vector<ModelPlane> DescribePlanes(const PlaneProblem& problem);

}  // namespace tsar
