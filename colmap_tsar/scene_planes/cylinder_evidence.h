// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/label_view.h"
#include "colmap_tsar/scene_planes/model_cylinder.h"
#include "colmap_tsar/scene_planes/scene_model.h"

#include <cstdint>
#include <vector>

namespace tsar {

// What views tell about the known part of a cylinder, in pixels of rasters.
// Whole numbers: sums do not depend on the order of views.
struct CylinderEvidence {
  int64_t area = 0;     // Of its front, where nothing was measured before it.
  int64_t through = 0;  // Of these, where the view saw what is behind it,
  // and where it measured a plane of the scene in the superpixel.
  int64_t on_planes = 0;

  CylinderEvidence& operator+=(const CylinderEvidence& other) {
    area += other.area;
    through += other.through;
    on_planes += other.on_planes;
    return *this;
  }
  // What else there may be is seen, or was measured, all over it. Single wrong
  // depths are not.
  bool IsContradicted() const {
    return 4 * through > area || 4 * on_planes > area;
  }
};

// Of one view, which needs superpixels and confident depths, by cylinder.
// planes: of the scene; labels: of the view.
std::vector<CylinderEvidence> TestCylinders(
    const ObservedView& view,
    const std::vector<ModelPlane>& planes,
    const ViewLabels& labels,
    const std::vector<ModelCylinder>& cylinders);

}  // namespace tsar
