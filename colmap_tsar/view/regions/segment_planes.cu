// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/segment_planes.h"

#include "colmap_tsar/device/atomic.h"
#include "colmap_tsar/device/parallel_for.h"

#include <cstddef>
#include <cstdint>

namespace tsar {
namespace {

// For each segment, the number of samples on planes minus those off them.
struct CountSamplesKernel {
  const int* segments;
  const RayDepth* samples;
  const Plane* planes;
  float max_gap;
  int* balances;

  TSAR_HD void operator()(int64_t i) const {
    const RayDepth& sample = samples[i];
    if (segments[i] >= 0 && sample.z > 0.f && planes[i].Valid()) {
      AtomicAdd(balances + segments[i],
                RelativeDistance(planes[i], sample) < max_gap ? 1 : -1);
    }
  }
};

struct TakePlanesKernel {
  const int* segments;
  const Plane* segment_planes;
  const int* balances_of_segments;
  const int* balances_of_regions;
  Plane* region_planes;

  TSAR_HD void operator()(int64_t i) const {
    const int segment = segments[i];
    if (segment >= 0 && segment_planes[i].Valid() &&
        balances_of_segments[segment] > 0 && balances_of_regions[segment] < 0) {
      region_planes[i] = segment_planes[i];
    }
  }
};

Buffer<int> CountSamples(const Regions& segments,
                         ImageView<const RayDepth> samples,
                         ImageView<const Plane> planes,
                         float max_gap,
                         Device& device) {
  Buffer<int> balances(device, static_cast<size_t>(segments.count));
  Fill(device, balances.Data(), balances.Size(), 0);
  ParallelFor(device,
              static_cast<int64_t>(planes.NumPixels()),
              CountSamplesKernel{segments.labels.View().data,
                                 samples.data,
                                 planes.data,
                                 max_gap,
                                 balances.Data()});
  return balances;
}

}  // namespace

void TakePlanesOfSegments(const Regions& segments,
                          ImageView<const RayDepth> samples,
                          ImageView<const Plane> segment_planes,
                          float max_gap,
                          ImageView<Plane> region_planes,
                          Device& device) {
  const Buffer<int> of_segments =
      CountSamples(segments, samples, segment_planes, max_gap, device);
  const Buffer<int> of_regions =
      CountSamples(segments, samples, region_planes, max_gap, device);
  ParallelFor(device,
              static_cast<int64_t>(region_planes.NumPixels()),
              TakePlanesKernel{segments.labels.View().data,
                               segment_planes.data,
                               of_segments.Data(),
                               of_regions.Data(),
                               region_planes.data});
}

}  // namespace tsar
