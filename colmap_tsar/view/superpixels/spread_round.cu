// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/spread_round.h"

#include "colmap_tsar/device/parallel_for.h"

#include <cmath>

namespace tsar {
namespace {

// The superpixel's plane if valid, else the trusted depth.
struct ApplyPlanesKernel {
  PlaneRaster planes;
  DepthNormalViews map;
  ImageView<const uint8_t> trusted;
  ImageView<float> depth;
  ImageView<Vec3f> normal;

  TSAR_HD void operator()(int x, int y) const {
    const Plane plane = planes.At(x, y);
    if (plane.Valid()) {
      depth(x, y) = plane.Depth(planes.intrinsics.Ray(x, y));
      normal(x, y) = plane.normal;
    } else {
      const bool is_trusted = trusted(x, y) != 0;
      depth(x, y) = is_trusted ? map.depth(x, y) : 0.f;
      normal(x, y) = is_trusted ? map.normal(x, y) : Vec3f{};
    }
  }
};

struct KeepKernel {
  DepthNormalViews estimate;
  TrustGate gate;
  ImageView<float> depth;
  ImageView<Vec3f> normal;
  ImageView<uint8_t> trusted;

  TSAR_HD void operator()(int x, int y) const {
    const bool may_pass = gate.readmit_filtered || trusted(x, y) != 0;
    const bool is_kept = may_pass && Passes(x, y);
    trusted(x, y) = is_kept ? 1 : 0;
    depth(x, y) = is_kept ? estimate.depth(x, y) : 0.f;
    normal(x, y) = is_kept ? estimate.normal(x, y) : Vec3f{};
  }

  TSAR_HD bool Passes(int x, int y) const {
    const float own = gate.own_depth(x, y);
    const float refined = estimate.depth(x, y);
    return own > 0.f && refined > 0.f &&
           fabsf(gate.scale.ToDisparity(refined) -
                 gate.scale.ToDisparity(own)) *
                   gate.score(x, y) <
               gate.tolerance;
  }
};

}  // namespace

DepthNormalImages CopyMap(const DepthNormalViews& map, Device& device) {
  DepthNormalImages copy(device, map.depth.width, map.depth.height);
  const size_t num_pixels = map.depth.NumPixels();
  Copy(device, map.depth.data, num_pixels, copy.depth.View().data);
  Copy(device, map.normal.data, num_pixels, copy.normal.View().data);
  return copy;
}

void SpreadRound(const PlaneRaster& planes,
                 ImageView<const Rgb> color,
                 const WeightedMedianOptions* filter,
                 const TrustGate& gate,
                 DepthNormalImages* map,
                 ImageView<uint8_t> trusted,
                 Device& device) {
  DepthNormalImages estimate(device, trusted.width, trusted.height);
  ParallelFor(device,
              trusted.width,
              trusted.height,
              ApplyPlanesKernel{planes,
                                map->Views(),
                                trusted,
                                estimate.depth.View(),
                                estimate.normal.View()});
  if (filter != nullptr) {
    estimate = WeightedMedianFilter(
        estimate.Views(), color, {}, planes.intrinsics, *filter, device);
  }
  ParallelFor(device,
              trusted.width,
              trusted.height,
              KeepKernel{estimate.Views(),
                         gate,
                         map->depth.View(),
                         map->normal.View(),
                         trusted});
}

}  // namespace tsar
