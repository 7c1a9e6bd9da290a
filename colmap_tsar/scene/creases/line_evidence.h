// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/creases/plane_lines.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <array>
#include <vector>

namespace tsar {

// Measurements around a line on a plane, summed over views. Measured pixels
// count by their confidence. All sums are whole numbers, so that the order of
// the views does not matter.
struct LineEvidence {
  // The two sides of the line: smaller and larger positions on its axis.
  struct Side {
    // The area labeled with the plane or with none, in views that would see the
    // orthogonal plane that begins at the line if the first one ended there.
    double area = 0.0;
    double measured = 0.0;  // Measured on the plane, in all views.
    double through = 0.0;   // Measured behind that orthogonal plane.
    int num_views = 0;      // Views that show enough of the area.
  };
  std::array<Side, 2> sides;
};

// The evidence of one view, by line. lines: from FindSharedLines. labels: as
// for MakePlaneProfiles.
std::vector<LineEvidence> TestPlaneLines(const ObservedView& view,
                                         const std::vector<int>& labels,
                                         const std::vector<PlaneLine>& lines,
                                         const SceneModel& model);

// Adds the evidence of another view.
void AddEvidence(const std::vector<LineEvidence>& of_view,
                 std::vector<LineEvidence>* sum);

}  // namespace tsar
