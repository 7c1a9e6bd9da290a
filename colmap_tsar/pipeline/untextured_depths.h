// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/pipeline/view_data.h"

#include <cstdint>

namespace tsar {

// Where the map to refine has no holes, no filter has removed what follows from
// a prior or from chance, and views agree on such depths as well. Then only
// those of them remain around which the image varies by more than its noise and
// three squared grey levels; the others become pixels without a hypothesis.
// Other maps, and hypotheses of the other type, remain as they are. Needs the
// colours and is_to_refine.
void DropUntexturedDepths(ViewData* view);

int64_t DropUntexturedDepthsWorkingBytes(int64_t num_pixels);

}  // namespace tsar
