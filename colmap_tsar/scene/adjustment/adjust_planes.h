// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/discovery/plane_measurement.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// A soft constraint: two planes are probably parallel, or orthogonal.
struct PlaneAnglePrior {
  enum class Kind { kParallel, kOrthogonal };
  Kind kind = Kind::kParallel;
  int first = -1;
  int second = -1;
  double sigma = 0.0;  // Standard deviation of the angle, in radians.
};

// A hard constraint: the normal of a plane is exactly a column of the rotation
// of a Manhattan frame, or its negative.
struct FrameColumn {
  int frame = -1;  // -1: the plane is free.
  int column = -1;
};

// Planes that are adjusted together, in the world frame, with the constraints
// on them that do not come from measured depths.
struct PlaneAdjustment {
  std::vector<WorldPlane> planes;       // Normals have unit length.
  std::vector<Eigen::Matrix3d> frames;  // Rotations.
  std::vector<FrameColumn> axes;        // One per plane, or none at all.
  std::vector<PlaneAnglePrior> angles;
};

// Measures the current planes in the views: any number of measurements per
// plane, in any order; see MeasurePlane.
using MeasurePlanes = std::function<std::vector<PlaneMeasurement>(
    const std::vector<WorldPlane>& planes)>;

struct AdjustedPlanes {
  // Each with its center, axes and covariance, marginalized over the other
  // planes. The axes are the principal ones of the error of the normal, with
  // which they are a right-handed basis. A parameter that nothing determines
  // has an infinite variance and no correlation with others.
  std::vector<ModelPlane> planes;
  std::vector<Eigen::Matrix3d> frames;
};

// Finds the planes and the rotations of the frames that agree best with the
// measurements and the angle priors, by nonlinear least squares (Ceres).
// Residuals are in expected errors; those of angles have a Cauchy loss. Each of
// at most max_rounds rounds measures the planes anew, with the weights of
// observations at the current planes, and adjusts them.
//
// Rotations known to no better than half a radian and shifts known to no better
// than half of the scene's size are unknown: a weak prior keeps them at their
// initial values, and their variances are infinite. A plane whose parameters
// are all unknown is returned unchanged, to the bit, unless it lies in a frame:
// then its normal is the frame's.
//
// The same input gives the same bits; one thread. Neither the origin nor the
// unit of length matters beyond rounding. Time and memory grow with the number
// of planes and measurements, as long as each plane shares angles with few
// others. Prints nothing.
//
// Throws std::invalid_argument where a plane or a measurement is not finite,
// a normal has not unit length, or lengths are too large for their squares.
AdjustedPlanes AdjustPlanes(const PlaneAdjustment& adjustment,
                            const MeasurePlanes& measure,
                            int max_rounds = 3);

// Angle priors for man-made scenes: each plane that lies in no Manhattan frame
// (ModelPlane::axis) is nearly parallel or orthogonal to the planes of its
// component with the largest support, where it is within 3 degrees of that.
// Each plane gets so few priors that their number is linear in that of the
// planes. planes: by decreasing support.
std::vector<PlaneAnglePrior> FindAnglePriors(
    const std::vector<ModelPlane>& planes);

// Adjusts the planes and frames of a scene together (AdjustPlanes), with the
// priors of FindAnglePriors, and sets their covariances. may_move: by plane,
// alike for all planes of a component. Planes that may not move stay, as do
// their frames, and those that do not lie exactly along their axis lose it.
// Undetermined planes stay, too. model: without labels.
void AdjustModel(const MeasurePlanes& measure,
                 const std::vector<bool>& may_move,
                 SceneModel* model);

}  // namespace tsar
