// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/thread_pool.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/surfaces/find_cylinders.h"
#include "colmap_tsar/scene/surfaces/seen_cylinders.h"

#include <cstddef>
#include <mutex>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// A search for the columns and pipes of a scene along the axes of its Manhattan
// frames: FindOutlines() for each view, then FindCircles() for each axis, then
// Test() with each view. The calls of one step may come from several threads.
// Memory holds the outlines of all views, four bytes for each row in which a
// pair of edges is seen, until the circles are found.
class CylinderSearch {
 public:
  // neighbors: by view, other views of the same surfaces; must outlive this
  // object.
  CylinderSearch(const std::vector<Eigen::Matrix3d>& frames,
                 const std::vector<std::vector<size_t>>& neighbors);

  size_t NumAxes() const { return axes_.size(); }

  // observed: with all parts of its evidence.
  void FindOutlines(size_t view, const ObservedView& observed);
  // Finds cylinders along an axis by the outlines of all views.
  void FindCircles(size_t axis, ThreadPool& threads);
  bool HasFoundAny() const;
  // planes: of the scene; labels: of the view.
  void Test(const ObservedView& observed,
            const std::vector<ModelPlane>& planes,
            const ViewLabels& labels);
  // The cylinders that the views do not contradict.
  std::vector<ModelCylinder> Result() const;

 private:
  struct Axis {
    AxisFrame frame;
    std::vector<OutlineView> outlines;  // By view.
    std::vector<ModelCylinder> cylinders;
    std::vector<CylinderEvidence> evidence;  // By cylinder.
  };

  const std::vector<std::vector<size_t>>& neighbors_;
  std::vector<Axis> axes_;
  std::mutex mutex_;  // Of the evidence.
};

}  // namespace tsar
