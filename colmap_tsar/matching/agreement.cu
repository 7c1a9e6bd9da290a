// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/agreement.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/matching/reprojection.cuh"

#include <cmath>

namespace tsar {
namespace {

struct AgreementKernel {
  ReferenceView reference;
  const SourceView* sources;
  int num_sources;
  AgreementOptions options;
  ImageView<uint8_t> counts;
  ImageView<uint8_t> seeing;

  TSAR_HD void operator()(int x, int y) const {
    const float depth = reference.depth(x, y);
    int count = 0;
    int num_seeing = 0;
    if (depth > 0.f) {
      const Vec3f point = reference.intrinsics.Ray(x, y) * depth;
      for (int s = 0; s < num_sources && count < 255; ++s) {
        count += Agrees(sources[s], point, x, y, &num_seeing) ? 1 : 0;
      }
    }
    counts(x, y) = static_cast<uint8_t>(count);
    seeing(x, y) = static_cast<uint8_t>(num_seeing < 255 ? num_seeing : 255);
  }

  TSAR_HD bool Agrees(const SourceView& source,
                      const Vec3f& point,
                      int x,
                      int y,
                      int* num_seeing) const {
    SeenThroughSource seen;
    if (!LookThroughSource(reference.intrinsics, source, point, &seen)) {
      return false;
    }
    // What the source sees in front of the point hides it.
    *num_seeing +=
        seen.point.z >= (1.f - options.max_depth_error) * point.z ? 1 : 0;
    if (!(fabsf(seen.point.z - point.z) <= options.max_depth_error * point.z)) {
      return false;
    }
    const float du = seen.x - x;
    const float dv = seen.y - y;
    return du * du + dv * dv <=
           options.max_reprojection_error * options.max_reprojection_error;
  }
};

}  // namespace

ViewAgreement CountAgreeingSources(const ReferenceView& reference,
                                          const Buffer<SourceView>& sources,
                                          const AgreementOptions& options,
                                          Device& device) {
  const int width = reference.depth.width;
  const int height = reference.depth.height;
  ViewAgreement result{DeviceImage<uint8_t>(device, width, height),
                       DeviceImage<uint8_t>(device, width, height)};
  ParallelFor(device,
              width,
              height,
              AgreementKernel{reference,
                              sources.Data(),
                              static_cast<int>(sources.Size()),
                              options,
                              result.agreeing.View(),
                              result.seeing.View()});
  return result;
}

}  // namespace tsar
