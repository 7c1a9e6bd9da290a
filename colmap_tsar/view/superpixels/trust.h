// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/view/superpixels/samples.h"
#include "colmap_tsar/view/superpixels/weighted_median.h"

#include <cstdint>

namespace tsar {

// The plane through the point depth * ray with this normal; zero where it does
// not face the camera.
TSAR_HD inline InverseDepthPlane ToInverseDepth(const Vec3f& ray,
                                                float depth,
                                                const Vec3f& normal) {
  const float slope = Dot(normal, ray);
  return depth > 0.f && slope < 0.f ? normal * (1.f / (depth * slope))
                                    : InverseDepthPlane{};
}

// The gate of Eq. 9: a pixel passes when its own disparity is within
// tolerance / n_aggr of the estimate.
struct TrustGate {
  ImageView<const float> score;  // n_aggr
  DisparityScale scale;
  float tolerance = 0.f;  // mu / N_c, in the paper's pixels
  // Whether pixels that are not trusted may pass, too.
  bool readmit_filtered = false;
};

// A round of R1: trusts the pixels whose own disparity passes the gate around
// the estimate (Eq. 9). The estimate is the plane of the superpixel, or the
// trusted pixel's own if there is none, filtered by F_A. own: 0 = no depth;
// planes: on the map's pixels; filter: null for none, its min_support is
// ignored; estimate: working memory; all of the map's size. Sets trusted to 1
// or 0.
void GateRound(const DepthNormalViews& own,
               const PlaneRaster& planes,
               ImageView<const Rgb> color,
               const WeightedMedianOptions* filter,
               const TrustGate& gate,
               ImageView<InverseDepthPlane> estimate,
               ImageView<uint8_t> trusted,
               Device& device);

}  // namespace tsar
