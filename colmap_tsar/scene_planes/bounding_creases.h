// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/planes/world_plane.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/scene_model.h"
#include "colmap_tsar/scene_planes/shared_lines.h"

#include <array>
#include <cstddef>
#include <map>
#include <vector>

namespace tsar {

// What views measured around a line, summed over them. In pixels of full
// confidence, but for the area.
struct LineEvidence {
  // Below the line's place on its axis, and above.
  struct Side {
    double area = 0.0;      // Pixels of the plane, or of none.
    double measured = 0.0;  // On the plane.
    // Seen through the half plane that stands at right angles on the line, if
    // the plane ends there.
    double through = 0.0;
    int num_views = 0;  // Of those that show some of the area, before it.
  };
  std::array<Side, 2> sides;

  LineEvidence& operator+=(const LineEvidence& other);
};

// Where a plane ends at a line, and beyond it another one begins at right
// angles, on the side of the cameras: that of a ceiling over a wall, of a wall
// beside another one, or on a floor.
struct BoundingCrease {
  int plane = -1;      // Ends here,
  int beyond = -1;     // and this one begins.
  WorldPlane limit;    // Where it does: the latter, toward the former.
  bool is_new = true;  // Nothing is known of `beyond` but that it begins there.
};

struct BoundingCreaseOptions {
  // So many views must show something of the area beyond, from before it.
  int min_views = 3;
  // How far, in relative depths of one pixel of disparity, a depth may be from
  // the plane to be measured on it, and behind the half plane without being
  // seen through it.
  float tolerance = 1.f;
  float min_through = 3.f;
  // What is nearer to the line than so many pixels tells nothing about it.
  float margin = 3.f;
  // Of the area beyond, the largest share that may be measured on the plane, or
  // seen through the half plane: some matches are wrong.
  double max_measured = 0.03;
  double max_through = 0.03;
  // The least area beyond in all views, in pixels, of a view to count, and what
  // must be measured on this side.
  double min_area = 200.0;
  double min_view_area = 50.0;
  double min_measured = 100.0;
  // A plane with so many parallel lines that have this share of what is
  // measured on either side is lined, as tiles and boards are: none of its
  // lines is a crease. Lines count that have this share of the crease's step.
  int min_lined = 2;
  double min_lined_share = 0.05;
  float min_lined_step = 0.3f;
  // A fall and a rise of brightness that are this close, in pixels, are one
  // dark crease between them.
  float max_crease_width = 14.f;
  // A plane of the model that lies within so many pixels of the new one is that
  // one, if this share of what was measured of the plane that ends was measured
  // of it.
  float max_offset = 10.f;
  double min_support = 0.1;
};

// By the numbers of lines.
using EvidenceOfLines = std::map<size_t, LineEvidence>;

// What one view tells of the lines on planes that it shows. labels, copies: as
// for FindPlaneLines; lines: sorted by plane.
EvidenceOfLines TestPlaneLines(const ObservedView& view,
                               const std::vector<int>& labels,
                               const std::vector<int>& copies,
                               const std::vector<SharedLine>& lines,
                               const SceneModel& model,
                               const BoundingCreaseOptions& options);

// The lines at which planes end: the last ones that views see in the same place
// of a plane, since a surface goes on as long as its lines are there, if
// nothing beyond was measured on the plane, and nothing through the one that
// begins there. Adds planes that begin there to the model. The same creases
// bound all copies of a plane.
std::vector<BoundingCrease> FindBoundingCreases(
    const std::vector<SharedLine>& lines,
    const std::vector<LineEvidence>& evidence,
    const std::vector<int>& copies,
    const BoundingCreaseOptions& options,
    SceneModel* model);

}  // namespace tsar
