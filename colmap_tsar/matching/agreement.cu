// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/agreement.h"

#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/matching/reprojection.cuh"

#include <cmath>

namespace tsar {
namespace {

// The largest reprojection error of an agreeing source after forward and
// backward reprojection, in pixels of the map: the limit of COLMAP's fusion.
constexpr float kMaxReprojectionError = 2.f;
// The largest depth error of an agreeing source, as a fraction of depth.
constexpr float kMaxDepthError = 0.01f;

struct AgreementKernel {
  ReferenceView reference;
  const SourceView* sources;
  int num_sources;

  TSAR_HD uint8_t operator()(int x, int y) const {
    const float depth = reference.depth(x, y);
    int count = 0;
    if (depth > 0.f) {
      const Vec3f point = reference.intrinsics.Ray(x, y) * depth;
      for (int s = 0; s < num_sources && count < 255; ++s) {
        count += Agrees(sources[s], point, x, y) ? 1 : 0;
      }
    }
    return static_cast<uint8_t>(count);
  }

  TSAR_HD bool Agrees(const SourceView& source,
                      const Vec3f& point,
                      int x,
                      int y) const {
    SeenThroughSource seen;
    return LookThroughSource(reference.intrinsics, source, point, &seen) &&
           fabsf(seen.point.z - point.z) <= kMaxDepthError * point.z &&
           seen.IsWithin(kMaxReprojectionError, x, y);
  }
};

}  // namespace

DeviceImage<uint8_t> CountAgreeingSources(const ReferenceView& reference,
                                          const SourceViews& sources,
                                          Device& device) {
  return MapPixels<uint8_t>(
      device,
      reference.depth.width,
      reference.depth.height,
      AgreementKernel{reference, sources.Data(), sources.Size()});
}

}  // namespace tsar
