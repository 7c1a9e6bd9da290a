// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/trust.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/view/superpixels/bilateral_kernel.cuh"

#include <cmath>

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

// Whether a pixel is tested at all. One of score 0 would pass any gate, so it
// must have been trusted before.
TSAR_HD inline bool MayPass(const TrustGate& gate,
                            int x,
                            int y,
                            bool was_trusted) {
  return gate.own_depth(x, y) > 0.f &&
         (was_trusted || (gate.readmit_filtered && gate.score(x, y) > 0.f));
}

TSAR_HD inline PixelGate MakePixelGate(const TrustGate& gate, int x, int y) {
  return {1.f / gate.own_depth(x, y),
          gate.scale.factor * gate.score(x, y),
          gate.tolerance};
}

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

struct GateByPlanesKernel {
  ImageView<const InverseDepthPlane> estimate;
  Intrinsics intrinsics;
  TrustGate gate;
  ImageView<uint8_t> trusted;

  TSAR_HD void operator()(int x, int y) const {
    trusted(x, y) =
        MayPass(gate, x, y, trusted(x, y) != 0) && Passes(x, y) ? 1 : 0;
  }

  TSAR_HD bool Passes(int x, int y) const {
    const PixelGate pixel = MakePixelGate(gate, x, y);
    const float inverse = Dot(estimate(x, y), intrinsics.Ray(x, y));
    return inverse > 0.f && !pixel.IsNearer(inverse) &&
           !pixel.IsFarther(inverse);
  }
};

struct GateByMedianKernel {
  ImageView<const InverseDepthPlane> estimate;
  ImageView<const Rgb> color;
  Intrinsics intrinsics;
  BilateralKernel taps;
  TrustGate gate;
  ImageView<uint8_t> trusted;

  TSAR_HD void operator()(int x, int y) const {
    trusted(x, y) =
        MayPass(gate, x, y, trusted(x, y) != 0) && Passes(x, y) ? 1 : 0;
  }

  TSAR_HD bool Passes(int x, int y) const {
    const PixelGate pixel = MakePixelGate(gate, x, y);
    const Vec3f ray = intrinsics.Ray(x, y);
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
        nearer += pixel.IsNearer(inverse) ? weight : 0.f;
        farther += pixel.IsFarther(inverse) ? weight : 0.f;
      }
    }
    // The median is the nearest depth with half of the weight not beyond it.
    return total > 0.f && 2.f * nearer < total && 2.f * farther <= total;
  }
};

}  // namespace

void GateByPlanes(ImageView<const InverseDepthPlane> estimate,
                  const Intrinsics& intrinsics,
                  const TrustGate& gate,
                  ImageView<uint8_t> trusted,
                  Device& device) {
  ParallelFor(device,
              trusted.width,
              trusted.height,
              GateByPlanesKernel{estimate, intrinsics, gate, trusted});
}

void GateByWeightedMedian(ImageView<const InverseDepthPlane> estimate,
                          ImageView<const Rgb> color,
                          const Intrinsics& intrinsics,
                          const WeightedMedianOptions& options,
                          const TrustGate& gate,
                          ImageView<uint8_t> trusted,
                          Device& device) {
  const BilateralKernelTable table(options, device);
  ParallelFor(device,
              trusted.width,
              trusted.height,
              GateByMedianKernel{
                  estimate, color, intrinsics, table.Taps(), gate, trusted});
}

void GateRound(const DepthNormalViews& own,
               const PlaneRaster& planes,
               ImageView<const Rgb> color,
               const WeightedMedianOptions* filter,
               const TrustGate& gate,
               ImageView<InverseDepthPlane> estimate,
               ImageView<uint8_t> trusted,
               Device& device) {
  ParallelFor(device,
              trusted.width,
              trusted.height,
              EstimateKernel{own, planes, trusted, estimate});
  if (filter != nullptr) {
    GateByWeightedMedian(
        estimate, color, planes.intrinsics, *filter, gate, trusted, device);
  } else {
    GateByPlanes(estimate, planes.intrinsics, gate, trusted, device);
  }
}

}  // namespace tsar
