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
// threads, and not at all once the run is to stop.
struct CylinderSearch {
  using OfView = std::function<void(size_t view, const ObservedView&)>;
  // cpu: with the threads of this axis.
  using OfAxis = std::function<void(size_t axis, Device& cpu)>;

  // For each view once, with all parts of its evidence, or with those for
  // neighbours.
  std::function<void(const std::string& name, const OfView& function)>
      visit_all;
  std::function<void(const std::string& name, const OfView& function)> visit;
  // For each of so many axes once.
  std::function<void(
      const std::string& name, size_t num_axes, const OfAxis& function)>
      visit_axes;
  std::function<bool()> should_stop;
};

// The columns and pipes of a scene along the axes of its Manhattan frames.
// neighbours: by view, the others that look at the same things. planes: of the
// scene; labels: by view. Where the run is to stop, what is found is of no use.
// Memory holds the outlines of all views, four bytes for each row in which a
// pair of edges is seen, until the circles are found.
std::vector<ModelCylinder> FindSceneCylinders(
    const std::vector<Eigen::Matrix3d>& frames,
    const std::vector<std::vector<size_t>>& neighbours,
    const std::vector<ModelPlane>& planes,
    const std::vector<const ViewLabels*>& labels,
    const CylinderSearch& search);

}  // namespace tsar
