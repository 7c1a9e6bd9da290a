// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/view/superpixels/samples.h"
#include "colmap_tsar/view/superpixels/slic.h"
#include "colmap_tsar/view/superpixels/superpixel_planes.h"
#include "colmap_tsar/view/superpixels/weighted_median.h"

#include <cstdint>

namespace tsar {

struct CorrelationOptions {
  int num_iterations = 4;            // N_t
  float window_radius = 5.f;         // delta, in pixels at the paper's width
  float disparity_tolerance = 24.f;  // mu, in the paper's pixels
  float spatial_sigma = 2.f;         // alpha
  float color_sigma = 3.f;           // beta
  // Whether pixels that were not reliable may become trusted, as by the paper's
  // gate. It improves a weak mask and degrades a strong one (docs/ablation.md).
  bool readmit_filtered = false;
  bool use_superpixel_planes = true;
  bool use_weighted_median = true;
  SuperpixelPlaneOptions planes;
};

// The result of R1: the trusted pixels, and the planes fitted to them.
struct CorrelationResult {
  // Nonzero where the pixel's own depth is trusted.
  DeviceImage<uint8_t> trusted;
  Buffer<Plane> planes;  // One per superpixel; may be invalid.
};

// R1 of the paper's iterative correlation refinement. Each round fits the
// superpixels' planes to the trusted pixels, replaces the map's depths by them,
// filters the result by F_A with a window that halves from round to round, and
// trusts the pixels whose own disparity is within mu / (n_aggr N_c) of it (Eq.
// 9). Trusted pixels keep their own depth. own: the measured hypotheses; score:
// n_aggr; reliable: the pixels trusted initially; all of the map's size.
// Superpixels live on raster.
CorrelationResult RefineByCorrelation(const DepthNormalViews& own,
                                      ImageView<const float> score,
                                      DeviceImage<uint8_t> reliable,
                                      ImageView<const Rgb> color,
                                      const Superpixels& superpixels,
                                      const ReducedRaster& raster,
                                      const Camera& camera,
                                      const DisparityScale& scale,
                                      const CorrelationOptions& options,
                                      Device& device);

// R2: fills pixels without a depth by the filter F_B, num_iterations times with
// a window that doubles from round to round; every round reads the one before.
// Returns the pixels that it filled (1, others 0) and changes map.
DeviceImage<uint8_t> InterpolateHoles(ImageView<const Rgb> color,
                                      const Intrinsics& intrinsics,
                                      int num_iterations,
                                      const WeightedMedianOptions& first,
                                      DepthNormalImages* map,
                                      Device& device);

}  // namespace tsar
