// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/plane_scores.h"
#include "colmap_tsar/scene_planes/superpixel_plane_fitter.h"

#include <vector>

namespace tsar {

// Drops planes, and replaces pairs by a joint fit, as long as one of these
// changes costs less than min_gain; the cheapest comes first. Returns whether
// there was any.
bool DropAndMergePlanes(const SuperpixelPlaneFitter& fitter,
                        double min_gain,
                        std::vector<ScoredPlane>* planes);

}  // namespace tsar
