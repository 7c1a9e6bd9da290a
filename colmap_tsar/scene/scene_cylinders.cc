// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/scene_cylinders.h"

#include "colmap_tsar/scene/surfaces/outline_edges.h"

#include <algorithm>
#include <optional>

namespace tsar {

CylinderSearch::CylinderSearch(
    const std::vector<Eigen::Matrix3d>& frames,
    const std::vector<std::vector<size_t>>& neighbors)
    : neighbors_(neighbors) {
  for (const Eigen::Matrix3d& frame : frames) {
    for (int axis = 0; axis < 3; ++axis) {
      axes_.push_back({{frame.col(axis), frame.col((axis + 1) % 3)},
                       std::vector<OutlineView>(neighbors.size()),
                       {},
                       {}});
    }
  }
}

void CylinderSearch::FindOutlines(size_t view, const ObservedView& observed) {
  for (Axis& axis : axes_) {
    if (const std::optional<AxisCamera> camera =
            MakeAxisCamera(observed.camera, axis.frame)) {
      axis.outlines[view] = {
          *camera,
          FindOutlinePairs(FindEdgesAcross(observed.evidence->color, *camera))};
    }
  }
}

void CylinderSearch::FindCircles(size_t index, ThreadPool& threads) {
  Axis& axis = axes_[index];
  axis.cylinders =
      FindCylinders(axis.outlines, neighbors_, axis.frame, threads);
  axis.evidence.resize(axis.cylinders.size());
  axis.outlines = {};
}

bool CylinderSearch::HasFoundAny() const {
  return std::any_of(axes_.begin(), axes_.end(), [](const Axis& axis) {
    return !axis.cylinders.empty();
  });
}

void CylinderSearch::Test(const ObservedView& observed,
                          const std::vector<ModelPlane>& planes,
                          const ViewLabels& labels) {
  for (Axis& axis : axes_) {
    const std::vector<CylinderEvidence> of_view =
        TestCylinders(observed, planes, labels, axis.cylinders);
    const std::lock_guard lock(mutex_);
    for (size_t k = 0; k < of_view.size(); ++k) {
      axis.evidence[k] += of_view[k];
    }
  }
}

std::vector<ModelCylinder> CylinderSearch::Result() const {
  std::vector<ModelCylinder> result;
  for (const Axis& axis : axes_) {
    for (size_t k = 0; k < axis.cylinders.size(); ++k) {
      if (!axis.evidence[k].IsContradicted()) {
        result.push_back(axis.cylinders[k]);
      }
    }
  }
  return result;
}

}  // namespace tsar
