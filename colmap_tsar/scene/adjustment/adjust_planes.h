// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/discovery/plane_measurement.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <functional>
#include <vector>

namespace tsar {

// Measures the current planes in the views: any number of measurements per
// plane, in any order; see MeasurePlane.
using MeasurePlanes = std::function<std::vector<PlaneMeasurement>(
    const std::vector<ModelPlane>& planes)>;

// Adjusts the planes and frames of a scene of any size together, by nonlinear
// least squares (Ceres), and sets the centers, axes and covariances of the
// planes. Planes of a frame stay exactly along its axes; others are softly tied
// to the largest planes of their component that are parallel or orthogonal to
// them within 3 degrees. The planes are measured again in each of a few rounds.
//
// model: planes by decreasing support, without labels. may_move: by plane,
// alike for all planes of a component. Planes that may not move stay, as do
// their frames, and those that do not lie exactly along their axis lose it.
// Free planes that no measurement determines stay, too.
//
// The covariances are marginalized over the other planes. The axes are the
// principal ones of the error of the normal, with which they are a right-handed
// basis. Rotations with a standard deviation above half a radian and shifts
// with one above half of the scene's size get an infinite variance and no
// correlation with others; nothing else is set where the shift is unknown.
//
// The same input gives the same bits; one thread. Neither the origin nor the
// unit of length matters beyond rounding.
void AdjustModel(const MeasurePlanes& measure,
                 const std::vector<bool>& may_move,
                 SceneModel* model);

}  // namespace tsar
