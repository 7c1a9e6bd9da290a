// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/evidence/scene_model.h"

#include <optional>
#include <string>

namespace tsar {

// The invariant of SceneModel that this one violates, as the fault ("a label
// that no plane has"); nothing where it satisfies all: unit vectors at right
// angles, finite numbers, frames that are rotations, labels of existing planes.
std::optional<std::string> FindSceneModelFault(const SceneModel& model);

}  // namespace tsar
