// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/raster_color.h"

#include "colmap_tsar/noise/denoise.h"
#include "colmap_tsar/noise/estimate_noise.h"
#include "colmap_tsar/pipeline/gray.h"
#include "colmap_tsar/superpixels/reduce_color.h"

#include <algorithm>
#include <utility>

namespace tsar {

DeviceImage<Rgb> MakeRasterColor(ImageView<const Rgb> color,
                                 const ReducedRaster& raster,
                                 bool denoise,
                                 Device& device) {
  DeviceImage<Rgb> reduced = ReduceColor(color, raster, device);
  if (!denoise) {
    return reduced;
  }
  const ImageView<const Rgb> noisy = std::as_const(reduced).View();
  const DeviceImage<float> gray = ComputeGray(noisy, device);
  return Denoise(
      noisy, gray.View(), EstimateNoise(gray.View(), device), {}, device);
}

}  // namespace tsar
