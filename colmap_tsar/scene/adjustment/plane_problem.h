// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/adjustment/adjust_planes.h"

#include <vector>

#include <Eigen/Core>

namespace tsar {

// One adjustment of planes to what views measured of them where they are.
struct PlaneProblem {
  PlaneAdjustment at;  // Valid; see AdjustPlanes.
  // For each plane a point that it turns about, off the plane or on it: amid
  // what was measured of it errors of turn and shift are nearly independent.
  std::vector<Eigen::Vector3d> middles;
  std::vector<PlaneMeasurement> measurements;
  double size = 1.0;  // Of the scene; above 0.
  double loss_scale = 1.0;
};

// Moves the planes and the frames of `at` to where they agree best with the
// measurements and angles, from where a prior keeps what these leave open;
// planes of a frame come to lie along it. False where nothing moves.
bool SolvePlanes(PlaneProblem* problem);

// The planes where they are, and how well they are known there.
std::vector<AdjustedPlane> DescribePlanes(const PlaneProblem& problem);

}  // namespace tsar
