// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/creases/line_evidence.h"
#include "colmap_tsar/scene/creases/shared_lines.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <vector>

namespace tsar {

// A line at which a plane ends and another one begins at right angles, on the
// side of the cameras: a ceiling over a wall, a wall beside another one, or on
// a floor.
struct BoundingCrease {
  int plane = -1;      // The plane that ends at the line.
  int beyond = -1;     // The plane that begins there.
  WorldPlane limit;    // `beyond`, oriented toward `plane`.
  bool is_new = true;  // `beyond` is known by its creases alone.
};

struct BoundingCreaseOptions {
  // The least number of views that show some of the area beyond, from in front
  // of it.
  int min_views = 3;
  // The largest shares of the area beyond that may be measured on the plane, or
  // seen through the plane that begins there: some matches are wrong. The
  // former is also relative to the measurements on this side.
  double max_measured = 0.03;
  double max_through = 0.03;
  // The least area beyond, summed over views, and the least sum of measurements
  // on this side, in pixels.
  double min_area = 200.0;
  double min_measured = 100.0;
  // This many parallel lines with this share of the measurements on either side
  // are a pattern, as of tiles and boards: none of the plane's lines is a
  // crease. Only lines with this share of the crease's step count.
  int min_pattern_lines = 2;
  double min_pattern_share = 0.05;
  float min_pattern_step = 0.7f;
  // A fall and a rise of brightness that are this close, in pixels, are one
  // dark crease between them.
  float max_crease_width = 14.f;
  // A plane of the model that passes within this many pixels of the crease,
  // almost parallel to the plane that would begin there, replaces it: the one
  // with the largest support, if that is at least this share of the support of
  // the plane that ends.
  float max_offset = 10.f;
  double min_support = 0.1;
};

// The lines at which planes end: the outermost lines that views share on a
// plane, since a surface extends at least to its last line, if nothing beyond
// was measured on the plane or through the one that begins there. Adds the
// planes that begin there to the model, centered on their creases. The same
// creases bound all copies of a plane. evidence: by line.
std::vector<BoundingCrease> FindBoundingCreases(
    const std::vector<SharedLine>& lines,
    const std::vector<LineEvidence>& evidence,
    const std::vector<int>& copies,
    const BoundingCreaseOptions& options,
    SceneModel* model);

}  // namespace tsar
