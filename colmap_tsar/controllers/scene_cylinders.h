// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/model_cylinder.h"
#include "colmap_tsar/scene_planes/scene_model.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// Calls a function for all views, from several threads, each view once. name:
// of this part of the pass.
using ObservedViewVisitor = std::function<void(
    const std::string& name,
    const std::function<void(size_t view, const ObservedView&)>& function)>;

// The columns and pipes of a scene along the axes of its Manhattan frames.
// neighbours: by view, the others that look at the same things. planes: of the
// scene; labels: by view. visit_all: with all parts of the views' evidence;
// visit: with those for neighbours.
std::vector<ModelCylinder> FindSceneCylinders(
    const std::vector<Eigen::Matrix3d>& frames,
    const std::vector<std::vector<size_t>>& neighbours,
    const std::vector<ModelPlane>& planes,
    const std::vector<const ViewLabels*>& labels,
    const ObservedViewVisitor& visit_all,
    const ObservedViewVisitor& visit);

}  // namespace tsar
