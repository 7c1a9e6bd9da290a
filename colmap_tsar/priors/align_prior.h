// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/priors/depth_prior.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tsar {

enum class PriorVerdict : uint8_t {
  kNone = 0,  // There is no prior.
  kUsed = 1,
  // It was dropped:
  kNoDepth = 2,       // It has no depths, but normals at most.
  kFewMeasured = 3,   // Too few of its pixels were measured.
  kUnlike = 4,        // It explains too little of the measured depths.
  kOthersUnlike = 5,  // Those of most images do (RemovePrior).
};

// The fit of an image's prior to its measurements.
struct PriorAssessment {
  PriorVerdict verdict = PriorVerdict::kNone;  // On its depths.
  // The fitted type of its values, and PriorFit::Skill(), at least 0, where
  // enough of its pixels were measured.
  PriorType type = PriorType::kAuto;
  float skill = 0.f;
  PriorVerdict of_normals = PriorVerdict::kNone;
  // The standard deviation of normals, in radians, in each of two directions,
  // where enough of them were measured.
  float normal_sigma = 0.f;

  bool IsUsed() const {
    return verdict == PriorVerdict::kUsed || of_normals == PriorVerdict::kUsed;
  }
  bool IsDropped() const {
    return !IsUsed() && (verdict != PriorVerdict::kNone ||
                         of_normals != PriorVerdict::kNone);
  }
};

// A description for the user; empty where there is no prior.
std::string Describe(const PriorAssessment& assessment);

// A prior in the units of the map, with an error model estimated from its
// residuals.
struct AlignedPrior {
  // 0 means no depth. Empty if the prior was dropped.
  Image<float> depth;
  // The standard deviation of the logarithm of each depth, but for a share of
  // outliers (outlier_share) with arbitrary errors.
  Image<float> sigma;
  float outlier_share = 0.f;
  // The mean of the unit normals of each superpixel (AlignNormals); the
  // shorter, the less they agree: see NormalSigma. Empty where they were
  // dropped.
  std::vector<Vec3f> normals;
  float normal_outlier_share = 0.f;
  PriorAssessment assessment;

  // Whether there is no depth.
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
