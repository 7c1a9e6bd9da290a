// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <cstdint>
#include <vector>

namespace tsar {

// The standard deviation of gray levels above which a measurement has full
// confidence.
inline constexpr float kMinTexture = 1.f;

bool IsMeasured(const RayDepth& sample);

// The residual of a measurement at a plane, in pixels of disparity.
float Residual(const RayDepth& sample,
               const Plane& plane,
               const DepthResolution& resolution);

// The distinct planes of a view's regions that become candidates: of those that
// are large enough, in the order of their first pixels.
struct RegionCandidates {
  std::vector<Plane> planes;
  // For each pixel of the raster the index of its region's plane among these,
  // plus one; 0 where it has none.
  Image<uint16_t> of_pixels;
};

RegionCandidates FindRegionCandidates(const EvidenceInputs& inputs);

struct PixelObservation {
  Observation observation;
  ObservationSource source = ObservationSource::kMeasured;
  float error = 1.f;  // See ViewEvidence::errors.
};

// The observation of each pixel: its measurement, else the plane of its region,
// or a prior; confidence 0 where there is none. confident_depth: of
// ViewEvidence.
Image<PixelObservation> ObservePixels(const EvidenceInputs& inputs,
                                      const RegionCandidates& regions,
                                      Image<float>* confident_depth);

}  // namespace tsar
