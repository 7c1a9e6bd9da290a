// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/creases/plane_lines.h"

#include <vector>

namespace tsar {

// The lines that the profiles of at least three views show together, with the
// mean step of those that show it. The result is sorted by plane, axis and
// position.
std::vector<PlaneLine> FindSharedLines(
    const std::vector<std::vector<PlaneProfile>>& of_views);

}  // namespace tsar
