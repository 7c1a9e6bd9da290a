// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <cstdint>

#include "benchmarks/scene/render.h"

namespace tsar {

// Maps with the faults of those that patch_match_stereo writes.
struct SimulatedMaps {
  // Dense: noise and some outliers where the image has texture, smooth and
  // wrong surfaces where it has none.
  DepthNormal photometric;
  // What the filter leaves: most of the first, little of the second.
  DepthNormal geometric;
};

// noise_key: differs between the views, so that their errors do not agree.
SimulatedMaps SimulateStereoMaps(const RenderedView& view,
                                 uint32_t noise_key,
                                 ThreadPool& threads);

}  // namespace tsar
