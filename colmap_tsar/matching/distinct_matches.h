// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/views.h"

#include <cstdint>

namespace tsar {

// Adds one at each pixel whose depth the source confirms as FilterHypotheses
// does and, beyond that, matches better than the depths that lie two and four
// pixels beside it in the source. On shading, every depth matches well, and on
// bare surfaces, any; so a depth that views agree on by a prior that they share
// passes that filter, but not this test.
//
// Passes over pixels that have options.min_num_consistent already.
void AddDistinctMatches(const ReferenceView& reference,
                        const SourceView& source,
                        const HypothesisFilterOptions& options,
                        ImageView<uint8_t> num_matches,
                        Device& device);

}  // namespace tsar
