// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/priors/fit_prior.h"

#include <string>

namespace tsar {

// A depth prior in the units of the map, with what its own residuals tell of
// its errors.
struct AlignedPrior {
  // 0: none. Empty where the prior was dropped.
  Image<float> depth;
  // The standard deviation of the logarithm of each depth. So many of them are
  // not normal but anything (outlier_share).
  Image<float> sigma;
  float outlier_share = 0.f;
  PriorFit fit;
  int num_samples = 0;
  // Why it was dropped; empty where it is used.
  std::string reason_to_drop;

  bool Empty() const { return depth.Empty(); }
};

// Aligns a prior with measured depths: one fit for the image, then a correction
// that varies from surface to surface (CorrectPrior). sigma grows with the
// distance from what was measured, and towards steps of the prior by as much
// as its residuals do there. It is calibrated, and outlier_share is found, by
// predicting measurements that were left out. A prior that explains too little
// of the measured depths is dropped.
//
// samples: depths that are to be trusted, on the raster of the result; z = 0
// where there is none.
AlignedPrior AlignPrior(const DepthPrior& prior,
                        const Image<RayDepth>& samples);

}  // namespace tsar
