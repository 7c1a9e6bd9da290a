// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The parts of a pass, each with a name. All call a function from several
// threads, and no longer once the run is to stop.
struct CylinderSearch {
  using OfView = std::function<void(size_t view, const ObservedView&)>;
  // cpu: has the threads for this axis.
  using OfAxis = std::function<void(size_t axis, Device& cpu)>;

  // Call the function once per view, with all parts of its evidence, or with
  // those for neighbors.
  std::function<void(const std::string& name, const OfView& function)>
      visit_all;
  std::function<void(const std::string& name, const OfView& function)> visit;
  // Calls the function once for each of num_axes axes.
  std::function<void(
      const std::string& name, size_t num_axes, const OfAxis& function)>
      visit_axes;
  std::function<bool()> should_stop;
};

// Finds the columns and pipes of a scene along the axes of its Manhattan
// frames. neighbors: by view, other views of the same surfaces. planes: of the
// scene; labels: by view. The result is invalid where the run is to stop.
// Memory holds the outlines of all views, four bytes for each row in which a
// pair of edges is seen, until the circles are found.
std::vector<ModelCylinder> FindSceneCylinders(
    const std::vector<Eigen::Matrix3d>& frames,
    const std::vector<std::vector<size_t>>& neighbors,
    const std::vector<ModelPlane>& planes,
    const std::vector<const ViewLabels*>& labels,
    const CylinderSearch& search);

}  // namespace tsar
