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

// What views measured around a line on a plane, summed over them. Whole numbers
// of pixels, so that the sum does not depend on the order of the views; those
// that were measured count by their confidence.
struct LineEvidence {
  // Below the line's place on its axis, and above.
  struct Side {
    // Of the plane, or of none, in views that would see the plane at right
    // angles that begins at the line if the first one ended there.
    double area = 0.0;
    double measured = 0.0;  // On the plane, in all views.
    double through = 0.0;   // Behind that plane: nothing hides what is there.
    int num_views = 0;      // That show enough of the area.
  };
  std::array<Side, 2> sides;
};

struct LineEvidenceOptions {
  // How far, in relative depths of one pixel of disparity, a depth may be from
  // the plane to be measured on it, and behind the one that begins at the line
  // without being seen through it.
  float tolerance = 1.f;
  float min_through = 3.f;
  // What is nearer to the line than so many pixels tells nothing about it.
  float margin = 3.f;
  // The least area for a view to count.
  double min_view_area = 50.0;
};

// What one view tells of the lines of one plane along one axis: those from
// `first` to `last`.
struct ViewLineEvidence {
  size_t first = 0;
  size_t last = 0;
  // Of these, the lines from begin to begin + lines.size() lie amid what the
  // view shows of the plane, or not far from it.
  size_t begin = 0;
  std::vector<LineEvidence> lines;
  // On the plane, all of it above the lines before and below those after.
  double measured = 0.0;
};

// lines: from JoinPlaneLines. labels, copies: as for FindPlaneLines.
std::vector<ViewLineEvidence> TestPlaneLines(
    const ObservedView& view,
    const std::vector<int>& labels,
    const std::vector<int>& copies,
    const std::vector<SharedLine>& lines,
    const SceneModel& model,
    const LineEvidenceOptions& options);

// Of all views.
class LineEvidenceSum {
 public:
  explicit LineEvidenceSum(size_t num_lines);

  void Add(const std::vector<ViewLineEvidence>& view);

  // By line.
  std::vector<LineEvidence> Get() const;

 private:
  std::vector<LineEvidence> of_lines_;
  // Differences from each line to the one before of what was measured on either
  // side in views that do not show it.
  std::vector<std::array<double, 2>> elsewhere_;
};

}  // namespace tsar
