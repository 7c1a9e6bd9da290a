// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/priors/fit_prior.h"

#include <cstdint>
#include <string>

namespace tsar {

enum class PriorVerdict : uint8_t {
  kNone = 0,  // There is no prior.
  kUsed = 1,
  // It was dropped:
  kNoDepth = 2,       // It has no depths, but normals alone.
  kFewMeasured = 3,   // Too few of its pixels were measured.
  kUnlike = 4,        // It explains too little of the measured depths.
  kOthersUnlike = 5,  // Those of most images do (RemovePrior).
};

// The fit of an image's depth prior to its measured depths.
struct PriorAssessment {
  PriorVerdict verdict = PriorVerdict::kNone;
  // The fitted type of its values, and PriorFit::Skill(), at least 0, where
  // enough of its pixels were measured.
  PriorType type = PriorType::kAuto;
  float skill = 0.f;

  bool IsDropped() const { return verdict > PriorVerdict::kUsed; }
};

// A description for the user; empty where there is no prior.
std::string Describe(const PriorAssessment& assessment);

// A depth prior in the units of the map, with an error model estimated from its
// residuals.
struct AlignedPrior {
  // 0 means no depth. Empty where the prior was dropped.
  Image<float> depth;
  // The standard deviation of the logarithm of each depth, but for a share of
  // outliers (outlier_share) with arbitrary errors.
  Image<float> sigma;
  float outlier_share = 0.f;
  PriorAssessment assessment;

  bool Empty() const { return depth.Empty(); }
};

// Aligns a prior with measured depths: one fit for the image, then a correction
// that varies from surface to surface (CorrectPrior). sigma grows with the
// distance from measurements, and near steps of the prior in proportion to its
// residuals there. sigma is calibrated, and outlier_share estimated, by
// predicting measurements that were held out. A prior that explains too little
// of the measured depths is dropped.
//
// samples: reliable depths, on the raster of the result; z = 0 where there is
// none.
AlignedPrior AlignPrior(const DepthPrior& prior,
                        const Image<RayDepth>& samples);

}  // namespace tsar
