// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/creases/shared_lines.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <array>
#include <cstddef>
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

// The evidence of one view for the lines of one plane along one axis: those
// from `first` to `last`.
struct ViewLineEvidence {
  size_t first = 0;
  size_t last = 0;
  // The lines from begin to begin + lines.size() lie in the part of the plane
  // that the view shows, or near it.
  size_t begin = 0;
  std::vector<LineEvidence> lines;
  // Measured on the plane: for the lines before `begin` all of it lies above,
  // for those after the last all of it lies below.
  double measured = 0.0;
};

// lines: from JoinPlaneLines. labels: as for FindPlaneLines.
std::vector<ViewLineEvidence> TestPlaneLines(
    const ObservedView& view,
    const std::vector<int>& labels,
    const std::vector<SharedLine>& lines,
    const SceneModel& model);

// The sum of the evidence of all views.
class LineEvidenceSum {
 public:
  explicit LineEvidenceSum(size_t num_lines);

  void Add(const std::vector<ViewLineEvidence>& view);

  // By line.
  std::vector<LineEvidence> Get() const;

 private:
  std::vector<LineEvidence> of_lines_;
  // Measured on either side of each line in views that do not show it, as
  // differences from the line before.
  std::vector<std::array<double, 2>> elsewhere_;
};

}  // namespace tsar
