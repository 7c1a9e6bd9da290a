// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/creases/line_evidence.h"
#include "colmap_tsar/scene/creases/plane_lines.h"
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
  bool is_new = true;  // `beyond` is known only from its creases.
};

// The lines at which planes end: the outermost lines that views share on a
// plane, since a surface extends at least to its last line, if nothing beyond
// was measured on the plane or through the one that begins there. Adds the
// planes that begin there to the model, centered on their creases. evidence: by
// line; copies: see FindPlaneCopies.
std::vector<BoundingCrease> FindBoundingCreases(
    const std::vector<PlaneLine>& lines,
    const std::vector<LineEvidence>& evidence,
    const std::vector<int>& copies,
    SceneModel* model);

}  // namespace tsar
