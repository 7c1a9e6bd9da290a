// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <vector>

namespace tsar {

// The planes that a view's prior proposes: for each superpixel the plane that
// best fits the prior in it and in its neighbors that continue it. None without
// a prior.
std::vector<Plane> ProposePlanesOfPrior(const ViewEvidence& evidence);

}  // namespace tsar
