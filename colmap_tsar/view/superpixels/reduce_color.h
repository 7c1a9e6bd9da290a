// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/superpixels/samples.h"

namespace tsar {

// The image reduced to the raster: the mean of the pixels under each reduced
// one, weighted by the area that it covers of them, rounded.
DeviceImage<Rgb> ReduceColor(ImageView<const Rgb> color,
                             const ReducedRaster& raster,
                             Device& device);

}  // namespace tsar
