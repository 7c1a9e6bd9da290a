// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/trust.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/view/superpixels/bilateral_kernel.cuh"

namespace tsar {
namespace {

// The gate of a pixel: `factor` turns the difference of two inverse depths into
// one of disparities, times n_aggr.
struct PixelGate {
  float inverse_depth;
  float factor;
  float tolerance;

  // Whether an inverse depth is outside the gate on the near or on the far
  // side.
  TSAR_HD bool IsNearer(float inverse) const {
    return (inverse - inverse_depth) * factor >= tolerance;
  }
  TSAR_HD bool IsFarther(float inverse) const {
    return (inverse_depth - inverse) * factor >= tolerance;
  }
};

// The superpixel's plane where there is one, else the trusted pixel's own.
struct EstimateKernel {
  DepthNormalViews own;
  PlaneRaster planes;
  ImageView<const uint8_t> trusted;
  ImageView<InverseDepthPlane> estimate;

  TSAR_HD void operator()(int x, int y) const {
    const Plane plane = planes.At(x, y);
    if (plane.Valid()) {
      estimate(x, y) = ToInverseDepth(plane);
    } else if (trusted(x, y) != 0) {
      estimate(x, y) = ToInverseDepth(
          planes.intrinsics.Ray(x, y), own.depth(x, y), own.normal(x, y));
    } else {
      estimate(x, y) = {};
    }
  }
};

// The estimate as it is.
struct OwnEstimate {
  ImageView<const InverseDepthPlane> estimate;

  TSAR_HD bool Passes(const PixelGate& gate,
                      const Vec3f& ray,
                      int x,
                      int y) const {
    const float inverse = Dot(estimate(x, y), ray);
    return inverse > 0.f && !gate.IsNearer(inverse) && !gate.IsFarther(inverse);
  }
};

// The estimate filtered by F_A, the weighted median of WeightedMedianFilter.
// The weights on both sides of an interval tell whether it holds the median, so
// that no median is computed.
struct MedianEstimate {
  ImageView<const InverseDepthPlane> estimate;
  ImageView<const Rgb> color;
  BilateralKernel taps;

  TSAR_HD bool Passes(const PixelGate& gate,
                      const Vec3f& ray,
                      int x,
                      int y) const {
    const Rgb center = color(x, y);
    float total = 0.f;
    float nearer = 0.f;
    float farther = 0.f;
    for (int row = -kTapRadius; row <= kTapRadius; ++row) {
      const int tap_y = y + row * taps.stride;
      if (tap_y < 0 || tap_y >= estimate.height) {
        continue;
      }
      for (int column = -kTapRadius; column <= kTapRadius; ++column) {
        const int tap_x = x + column * taps.stride;
        if (tap_x < 0 || tap_x >= estimate.width) {
          continue;
        }
        const float inverse = Dot(estimate(tap_x, tap_y), ray);
        if (!(inverse > 0.f)) {
          continue;
        }
        const float weight =
            taps.Weight(column, row, center, color(tap_x, tap_y));
        total += weight;
        nearer += gate.IsNearer(inverse) ? weight : 0.f;
        farther += gate.IsFarther(inverse) ? weight : 0.f;
      }
    }
    // The median is the nearest depth with half of the weight not beyond it.
    return total > 0.f && 2.f * nearer < total && 2.f * farther <= total;
  }
};

template <typename Estimate>
struct GateKernel {
  ImageView<const float> own_depth;
  Intrinsics intrinsics;
  TrustGate gate;
  Estimate estimate;
  ImageView<uint8_t> trusted;

  TSAR_HD void operator()(int x, int y) const {
    // A pixel of score 0 would pass any gate, so it must have been trusted
    // before.
    const bool may_pass = own_depth(x, y) > 0.f &&
                          (trusted(x, y) != 0 ||
                           (gate.readmit_filtered && gate.score(x, y) > 0.f));
    trusted(x, y) = may_pass && Passes(x, y) ? 1 : 0;
  }

  TSAR_HD bool Passes(int x, int y) const {
    const PixelGate pixel{1.f / own_depth(x, y),
                          gate.scale.factor * gate.score(x, y),
                          gate.tolerance};
    return estimate.Passes(pixel, intrinsics.Ray(x, y), x, y);
  }
};

}  // namespace

void GateRound(const DepthNormalViews& own,
               const PlaneRaster& planes,
               ImageView<const Rgb> color,
               const WeightedMedianOptions* filter,
               const TrustGate& gate,
               ImageView<InverseDepthPlane> estimate,
               ImageView<uint8_t> trusted,
               Device& device) {
  const int width = trusted.width;
  const int height = trusted.height;
  ParallelFor(
      device, width, height, EstimateKernel{own, planes, trusted, estimate});
  if (filter == nullptr) {
    ParallelFor(device,
                width,
                height,
                GateKernel<OwnEstimate>{
                    own.depth, planes.intrinsics, gate, {estimate}, trusted});
    return;
  }
  const BilateralKernelTable table(*filter, device);
  ParallelFor(device,
              width,
              height,
              GateKernel<MedianEstimate>{own.depth,
                                         planes.intrinsics,
                                         gate,
                                         {estimate, color, table.Taps()},
                                         trusted});
}

}  // namespace tsar
