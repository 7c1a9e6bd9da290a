// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/curved_surface.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <cstddef>
#include <vector>

// Rays and depths in one array for each of their numbers, which loops over many
// of them work on several at a time.
namespace tsar {

// Which ones of such arrays.
struct SampleRange {
  // A range begins at a multiple of this, and loops run on to the next one
  // after its end: over numbers that are there but mean nothing.
  static constexpr int kAlignment = 4;

  int begin = 0;
  int count = 0;

  size_t Begin() const { return static_cast<size_t>(begin); }
  size_t Count() const { return static_cast<size_t>(count); }
  // As many as loops run over.
  size_t PaddedCount() const {
    return (Count() + kAlignment - 1) / kAlignment * kAlignment;
  }
};

// Rays (x, y, 1).
struct RaySamples {
  std::vector<float> x;
  std::vector<float> y;

  SampleRange Add(const std::vector<Vec3f>& rays);
};

// Depths that were measured.
struct DepthSamples {
  RaySamples rays;
  std::vector<float> depth;       // > 0
  std::vector<float> confidence;  // As in Observation.
  // One pixel of disparity there: the relative change of the depth,
  std::vector<float> relative_error;
  // and its change.
  std::vector<float> error;

  SampleRange Add(const std::vector<Observation>& observations,
                  const DepthResolution& resolution);
};

// The depths at which rays meet a surface, 0 where they do not. depths:
// range.PaddedCount() ones.
void ComputeDepths(const CurvedSurface& surface,
                   const RaySamples& rays,
                   const SampleRange& range,
                   float* depths);

// How far depths are off a surface, in pixels of disparity; infinite where the
// ray does not meet it. differences: range.PaddedCount() ones.
void ComputeDifferences(const CurvedSurface& surface,
                        const DepthSamples& samples,
                        const SampleRange& range,
                        float* differences);

}  // namespace tsar
