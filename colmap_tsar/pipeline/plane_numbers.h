// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/pipeline/find_scene.h"

#include <cstdint>
#include <limits>

namespace tsar {

// A plane map names the first so many planes of the model, which are those of
// largest support: by one more than their numbers, in 16 bits.
inline constexpr int kMaxPlanesOfMap = std::numeric_limits<uint16_t>::max();

// What a plane map may say in each pixel of the raster: the plane that its
// superpixel was labelled with. 0 where there is none, or a curved surface, or
// one that plane maps cannot name.
Image<uint16_t> PlaneNumbers(const Image<uint16_t>& superpixels,
                             const FoundScene& found);

}  // namespace tsar
