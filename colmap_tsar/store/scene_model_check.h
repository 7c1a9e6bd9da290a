// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/scene_model.h"

#include <optional>
#include <string>

namespace tsar {

// Which promise of SceneModel this one breaks, as what it has ("a label that no
// plane has"); nothing where it keeps all: unit vectors at right angles, finite
// numbers, frames that are rotations, labels of planes that there are.
std::optional<std::string> FindSceneModelFault(const SceneModel& model);

}  // namespace tsar
