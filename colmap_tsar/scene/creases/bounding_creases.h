// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/creases/line_evidence.h"
#include "colmap_tsar/scene/creases/shared_lines.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <vector>

namespace tsar {

// Where a plane ends at a line, and beyond it another one begins at right
// angles, on the side of the cameras: that of a ceiling over a wall, of a wall
// beside another one, or on a floor.
struct BoundingCrease {
  int plane = -1;      // Ends here,
  int beyond = -1;     // and this one begins.
  WorldPlane limit;    // Where it does: the latter, toward the former.
  bool is_new = true;  // Nothing is known of `beyond` but its creases.
};

struct BoundingCreaseOptions {
  // So many views must show something of the area beyond, from before it.
  int min_views = 3;
  // Of the area beyond, the largest share that may be measured on the plane, or
  // seen through the one that begins there: some matches are wrong. The former
  // is also the largest share of what is measured on this side.
  double max_measured = 0.03;
  double max_through = 0.03;
  // The least area beyond in all views, in pixels, and what must be measured on
  // this side.
  double min_area = 200.0;
  double min_measured = 100.0;
  // So many parallel lines that have this share of what is measured on either
  // side are a pattern, as of tiles and boards: none of the plane's lines is a
  // crease. Lines count that have this share of the crease's step.
  int min_pattern_lines = 2;
  double min_pattern_share = 0.05;
  float min_pattern_step = 0.7f;
  // A fall and a rise of brightness that are this close, in pixels, are one
  // dark crease between them.
  float max_crease_width = 14.f;
  // Of the planes of the model that pass within so many pixels of the crease,
  // almost parallel to the one that would begin there, the one that is measured
  // most takes its place, if that is this share of what was measured of the
  // plane that ends.
  float max_offset = 10.f;
  double min_support = 0.1;
};

// The lines at which planes end: the last ones that views see in the same place
// of a plane, since a surface goes on as long as its lines are there, if
// nothing beyond was measured on the plane, and nothing through the one that
// begins there. Adds planes that begin there to the model, in the middle of
// their creases. The same creases bound all copies of a plane. evidence: by
// line.
std::vector<BoundingCrease> FindBoundingCreases(
    const std::vector<SharedLine>& lines,
    const std::vector<LineEvidence>& evidence,
    const std::vector<int>& copies,
    const BoundingCreaseOptions& options,
    SceneModel* model);

}  // namespace tsar
