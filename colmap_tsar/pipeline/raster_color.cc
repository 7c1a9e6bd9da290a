// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/raster_color.h"

#include "colmap_tsar/noise/denoise.h"
#include "colmap_tsar/noise/estimate_noise.h"
#include "colmap_tsar/pipeline/gray.h"
#include "colmap_tsar/superpixels/reduce_color.h"

#include <cstdlib>
#include <cstdio>
#include <cmath>
#include <utility>

namespace tsar {

DeviceImage<Rgb> MakeRasterColor(ImageView<const Rgb> color,
                                 const ReducedRaster& raster,
                                 Device& device) {
  DeviceImage<Rgb> reduced = ReduceColor(color, raster, device);
  const DeviceImage<float> gray = ComputeGray(std::as_const(reduced).View(), device);
  const NoiseCurve noise = EstimateNoise(gray.View(), device);
  DenoiseOptions o;
  if (getenv("DN_S")) o.strength = atof(getenv("DN_S"));
  if (getenv("DN_R")) o.search_radius = atoi(getenv("DN_R"));
  if (getenv("DN_P")) o.patch_radius = atoi(getenv("DN_P"));
  if (o.strength == 0) return reduced;
  if (getenv("DN_V")) fprintf(stderr, "noise %.3f %.5f sigma(128) %.2f\n", noise.constant, noise.per_level, sqrt(noise.Variance(128)));
  return Denoise(std::as_const(reduced).View(), gray.View(), noise, o, device);
}

}  // namespace tsar
