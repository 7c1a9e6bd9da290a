// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/views.h"

#include <cstdint>

namespace tsar {

// Adds one at each pixel whose depth the source confirms as in FilterHypotheses
// and that also matches better than the depths two and four pixels beside it in
// the source. On shading and on textureless surfaces any depth matches well; so
// a depth on which views agree due to a common prior passes that filter, but
// not this test.
//
// Skips pixels that have options.min_num_consistent already.
void AddDistinctMatches(const ReferenceView& reference,
                        const SourceView& source,
                        const HypothesisFilterOptions& options,
                        ImageView<uint8_t> num_matches,
                        Device& device);

}  // namespace tsar
