// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/adjust_planes.h"
#include "colmap_tsar/scene_planes/scene_model.h"

#include <vector>

namespace tsar {

// Adjusts the planes and frames of a scene together (AdjustPlanes), with the
// priors of FindAnglePriors, and sets how well each plane is known. Of each
// component all planes may move, or none (may_move): then they and their frames
// stay as they are, and planes that do not lie exactly along their axis lose
// it. Planes of which nothing is known stay, too. model: without labels.
void AdjustModel(const MeasurePlanes& measure,
                 const std::vector<bool>& may_move,
                 SceneModel* model);

}  // namespace tsar
