// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/adjust_planes.h"

#include <vector>

namespace tsar {

// The preconditions of AdjustPlanes: throws std::invalid_argument, which names
// the first thing that breaks them.
void CheckAdjustment(const PlaneAdjustment& adjustment,
                     const AdjustPlanesOptions& options);
void CheckMeasurements(const std::vector<PlaneMeasurement>& measurements,
                       int num_planes);

}  // namespace tsar
