// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/compose.h"
#include "colmap_tsar/view/refine_observer.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/refined_maps.h"

#include <cstdint>

namespace tsar {

// R2: fills small holes by weighted medians, and marks them as interpolated.
// color, intrinsics: those of the map. num_iterations: each fills holes of at
// most a window's width. Does nothing if the options disable it.
void FillHoles(ImageView<const Rgb> color,
               const Intrinsics& intrinsics,
               const RefineOptions& options,
               int num_iterations,
               ComposedMap* composed,
               Device& device);

// Downloads the maps that are always made. Normals that face away from the
// camera, a few of those that were measured at grazing angles, are tilted as
// little as is needed; all others keep their bytes. intrinsics: of the map.
void Download(const ComposedMap& composed,
              const DeviceImage<float>& confidence,
              const Intrinsics& intrinsics,
              RefinedMaps* maps);

// Shows the result to the observer unless it is null.
void ShowMaps(StageObserver* observer, const RefinedMaps& maps);

}  // namespace tsar
