// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/evidence/observed_source.h"
#include "colmap_tsar/scene/evidence/observed_view.h"

namespace tsar {

// Estimates the gain from the points that both views measured; neutral where
// these are few.
ColorGain EstimateColorGain(const ObservedView& reference,
                            const ObservedView& source);

}  // namespace tsar
