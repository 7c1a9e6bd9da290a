// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/superpixels/samples.h"

namespace tsar {

// The image that superpixels, regions and borders are found in: reduced to the
// raster, without its noise.
DeviceImage<Rgb> MakeRasterColor(ImageView<const Rgb> color,
                                 const ReducedRaster& raster,
                                 Device& device);

}  // namespace tsar
