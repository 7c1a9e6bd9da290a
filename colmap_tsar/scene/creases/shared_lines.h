// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/creases/plane_lines.h"

#include <vector>

namespace tsar {

// The lines that several views see at the same position on a plane, with the
// median pixel and the mean step; steps of opposite signs are different lines.
// lines: by view. The result is sorted by plane, axis and position.
std::vector<PlaneLine> JoinPlaneLines(
    const std::vector<std::vector<PlaneLine>>& lines);

}  // namespace tsar
