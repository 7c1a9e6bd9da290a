// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/scene_cylinders.h"

#include "colmap_tsar/scene/surfaces/find_cylinders.h"
#include "colmap_tsar/scene/surfaces/outline_edges.h"
#include "colmap_tsar/scene/surfaces/seen_cylinders.h"

#include <mutex>
#include <optional>
#include <utility>

namespace tsar {
namespace {

std::vector<AxisFrame> AxesOf(const std::vector<Eigen::Matrix3d>& frames) {
  std::vector<AxisFrame> axes;
  for (const Eigen::Matrix3d& frame : frames) {
    for (int axis = 0; axis < 3; ++axis) {
      axes.push_back({frame.col(axis), frame.col((axis + 1) % 3)});
    }
  }
  return axes;
}

OutlineView FindOutlines(const ObservedView& view, const AxisFrame& axis) {
  const std::optional<AxisCamera> camera = MakeAxisCamera(view.camera, axis);
  if (!camera) {
    return {};
  }
  return {*camera,
          FindOutlinePairs(
              FindEdgesAcross(view.evidence->color, view.camera, *camera), {})};
}

// Finds cylinders along all axes by the outlines of all views, which are freed.
std::vector<ModelCylinder> FindByOutlines(
    const std::vector<AxisFrame>& axes,
    const std::vector<std::vector<size_t>>& neighbors,
    const CylinderSearch& search) {
  std::vector<std::vector<OutlineView>> outlines(
      axes.size(), std::vector<OutlineView>(neighbors.size()));
  search.visit_all("outlines", [&](size_t view, const ObservedView& observed) {
    for (size_t axis = 0; axis < axes.size(); ++axis) {
      outlines[axis][view] = FindOutlines(observed, axes[axis]);
    }
  });
  if (search.should_stop()) {
    return {};
  }
  std::vector<std::vector<ModelCylinder>> along(axes.size());
  search.visit_axes("circles", axes.size(), [&](size_t axis, Device& cpu) {
    along[axis] =
        FindCylinders(outlines[axis], neighbors, axes[axis], {}, cpu.Threads());
    outlines[axis] = {};
  });
  std::vector<ModelCylinder> cylinders;
  for (const std::vector<ModelCylinder>& of_axis : along) {
    cylinders.insert(cylinders.end(), of_axis.begin(), of_axis.end());
  }
  return cylinders;
}

}  // namespace

std::vector<ModelCylinder> FindSceneCylinders(
    const std::vector<Eigen::Matrix3d>& frames,
    const std::vector<std::vector<size_t>>& neighbors,
    const std::vector<ModelPlane>& planes,
    const std::vector<const ViewLabels*>& labels,
    const CylinderSearch& search) {
  const std::vector<AxisFrame> axes = AxesOf(frames);
  if (axes.empty()) {
    return {};
  }
  const std::vector<ModelCylinder> cylinders =
      FindByOutlines(axes, neighbors, search);
  if (cylinders.empty() || search.should_stop()) {
    return {};
  }
  std::vector<CylinderEvidence> evidence(cylinders.size());
  std::mutex mutex;
  search.visit("columns", [&](size_t view, const ObservedView& observed) {
    const std::vector<CylinderEvidence> of_view =
        TestCylinders(observed, planes, *labels[view], cylinders);
    const std::lock_guard lock(mutex);
    for (size_t k = 0; k < evidence.size(); ++k) {
      evidence[k] += of_view[k];
    }
  });
  std::vector<ModelCylinder> result;
  for (size_t k = 0; k < cylinders.size(); ++k) {
    if (!evidence[k].IsContradicted()) {
      result.push_back(cylinders[k]);
    }
  }
  return result;
}

}  // namespace tsar
