// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/superpixels/samples.h"

#include <cstdint>

namespace tsar {

// The image that superpixels, regions, textures and borders are found in:
// reduced to the raster and, if denoise says so, without its noise.
DeviceImage<Rgb> MakeRasterColor(ImageView<const Rgb> color,
                                 const ReducedRaster& raster,
                                 bool denoise,
                                 Device& device);

}  // namespace tsar
