// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/adjust_planes.h"
#include "colmap_tsar/scene_planes/scene_model.h"

namespace tsar {

// Adjusts all planes and frames of a scene together (AdjustPlanes), with the
// priors of FindAnglePriors, and sets how well each is known. Planes of which
// nothing is known stay as they are. model: without labels.
void AdjustModel(const MeasurePlanes& measure, SceneModel* model);

}  // namespace tsar
