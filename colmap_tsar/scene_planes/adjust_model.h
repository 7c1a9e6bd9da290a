// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/adjust_planes.h"
#include "colmap_tsar/scene_planes/scene_model.h"

#include <vector>

namespace tsar {

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
