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

// Two planes that are probably parallel, or orthogonal.
struct PlaneAnglePrior {
  enum class Kind { kParallel, kOrthogonal };
  Kind kind = Kind::kParallel;
  int first = -1;
  int second = -1;
  double sigma = 0.0;  // Standard deviation of the angle, in radians.
};

// Puts a plane into a Manhattan frame: its normal is exactly a column of the
// frame's rotation, or the opposite of that.
struct FrameColumn {
  int frame = -1;  // -1: the plane is free.
  int column = -1;
};

// Planes that are adjusted together, in the world frame, and what is known of
// them beside measured depths.
struct PlaneAdjustment {
  std::vector<WorldPlane> planes;       // Of unit normals.
  std::vector<Eigen::Matrix3d> frames;  // Rotations.
  std::vector<FrameColumn> axes;        // One per plane, or none at all.
  std::vector<PlaneAnglePrior> angles;
};

// What views measured of the planes as they are at the moment, in any order and
// any number per plane; see MeasurePlane.
using MeasurePlanes = std::function<std::vector<PlaneMeasurement>(
    const std::vector<WorldPlane>& planes)>;

struct AdjustPlanesOptions {
  // Planes are measured anew, with the weights that observations have at their
  // new places, and adjusted again, this often at most.
  int max_rounds = 3;
  // The error at which the loss of angles turns from squares to logarithms, in
  // their standard deviations.
  double loss_scale = 1.0;
};

struct AdjustedPlane {
  WorldPlane plane;
  // A point on it amid what was measured, and two orthogonal unit vectors along
  // it, the principal axes of its errors of direction; with the normal they are
  // a right-handed basis.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_s = Eigen::Vector3d::UnitX();
  Eigen::Vector3d axis_t = Eigen::Vector3d::UnitY();
  // Of the rotation about axis_s and about axis_t (through the centre, radians)
  // and of the shift along the normal, with all that the other planes leave
  // open. A quantity that nothing determines has an infinite variance, and no
  // correlation with others.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

struct AdjustedPlanes {
  std::vector<AdjustedPlane> planes;
  std::vector<Eigen::Matrix3d> frames;
  int num_rounds = 0;
};

// Finds the planes and the rotations of the frames that agree best with what
// views measured and with the angles, each by its expected error and the angles
// with Cauchy's loss, by nonlinear least squares (Ceres).
//
// Directions known to no better than half a radian and places known to no
// better than half of the scene's size are unknown: a weak prior keeps them
// where they are, and their variances are infinite. A plane of which everything
// is unknown is returned unchanged, to the bit, unless it lies in a frame: then
// its normal is the frame's.
//
// The same input gives the same bits; one thread. Neither the place of the
// origin nor the unit of length matters beyond rounding. Time and memory grow
// with the number of planes and measurements, as long as each plane shares
// angles with few others. Prints nothing.
//
// Throws std::invalid_argument where a number is not finite or out of range (a
// sigma below 1e-9 radians, too), a normal has not unit length, a frame is no
// rotation, an index names no plane or frame, or a pair is twice the same
// plane; this also goes for what `measure` returns.
AdjustedPlanes AdjustPlanes(const PlaneAdjustment& adjustment,
                            const MeasurePlanes& measure,
                            const AdjustPlanesOptions& options = {});

// What is probably true of planes that people built: each plane that lies in no
// Manhattan frame (ModelPlane::axis) is as good as parallel or orthogonal to
// the planes of its component that have most support, where it is within 3
// degrees of that. To so few of them that the number of priors grows with that
// of the planes. planes: by falling support.
std::vector<PlaneAnglePrior> FindAnglePriors(
    const std::vector<ModelPlane>& planes);

// Adjusts the planes and frames of a scene together (AdjustPlanes), with the
// priors of FindAnglePriors, and sets how well each plane is known. Of each
// component all planes may move, or none (may_move): then they and their frames
// stay as they are, and planes that do not lie exactly along their axis lose
// it. Planes of which nothing is known stay, too. model: without labels.
void AdjustModel(const MeasurePlanes& measure,
                 const std::vector<bool>& may_move,
                 SceneModel* model);

}  // namespace tsar
