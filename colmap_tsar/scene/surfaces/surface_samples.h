// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/curved_surface.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <cstddef>
#include <vector>

// Rays and depths as one array per component, so that loops are vectorized.
namespace tsar {

// A range of samples in the arrays below.
struct SampleRange {
  // A range begins at a multiple of this, and loops run on to the next one
  // after its end: over values that exist but are ignored.
  static constexpr size_t kAlignment = 4;

  size_t begin = 0;
  size_t count = 0;

  // The number of values that loops run over.
  size_t PaddedCount() const {
    return (count + kAlignment - 1) / kAlignment * kAlignment;
  }
};

// Rays (x, y, 1).
struct RaySamples {
  std::vector<float> x;
  std::vector<float> y;

  SampleRange Add(const std::vector<Vec3f>& rays);
};

// Measured depths.
struct DepthSamples {
  RaySamples rays;
  std::vector<float> depth;       // > 0
  std::vector<float> confidence;  // As in Observation.
  // The change of depth by one pixel of disparity there: relative,
  std::vector<float> relative_error;
  // and absolute.
  std::vector<float> error;

  SampleRange Add(const std::vector<Observation>& observations,
                  const DepthResolution& resolution);
};

// The depths at which rays intersect a surface, 0 where they do not. depths:
// range.PaddedCount() values.
void ComputeDepths(const CurvedSurface& surface,
                   const RaySamples& rays,
                   const SampleRange& range,
                   float* depths);

// The residuals of depths at a surface, in pixels of disparity; infinite where
// the ray does not intersect it. differences: range.PaddedCount() values.
void ComputeDifferences(const CurvedSurface& surface,
                        const DepthSamples& samples,
                        const SampleRange& range,
                        float* differences);

}  // namespace tsar
