// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/priors/align_prior.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <cstdint>
#include <vector>

namespace tsar {

struct EvidenceOptions {
  // The standard deviation of gray levels above which a measurement has full
  // confidence, and the confidence on weaker texture.
  float min_texture = 1.f;
  float confidence_without_texture = 0.5f;
  // The confidence of measurements is multiplied by the square of their
  // fattening weight, but by no less than this, above 0, where the texture is
  // not the pixel's own.
  float min_own_confidence = 0.02f;
  // The confidence of a pixel that was not measured, but lies in a region that
  // has a plane.
  float confidence_of_region_plane = 0.3f;
  // That confidence is lower where measurements in the same superpixel have
  // residuals at the plane above this multiple of RelativeDepthError().
  float max_region_plane_residual = 6.f;
  // The confidence of a pixel whose depth comes from a prior alone: errors of
  // priors are correlated over whole surfaces.
  float confidence_of_prior = 0.1f;
  // The tolerances of priors, in their standard deviations, and of
  // measurements, in expected errors.
  float prior_tolerance = 2.f;
  float tolerance = 1.f;
  int max_observations_per_superpixel = 32;
  int max_priors_per_superpixel = 12;
  int max_confirmed_per_superpixel = 12;
  // The weight of a pair of pixels across a border is
  // base + contrast exp(-edge / scale), edge in gray levels.
  float border_base = 0.05f;
  float border_contrast = 2.f;
  float border_scale = 4.f;
};

// The results of the stages in one view, on the raster of its superpixels.
struct EvidenceInputs {
  Image<int> superpixels;                // Labels in [0, num_superpixels).
  int num_superpixels = 0;               // At most 65536.
  std::vector<Plane> superpixel_planes;  // Invalid where there is none.
  Image<RayDepth> samples;               // Trusted measurements; z = 0: none.
  // Measurements that other views confirm, trusted or not; may be empty.
  Image<RayDepth> confirmed_samples;
  Image<Plane> region_planes;  // Of each pixel; may be empty.
  Image<float> texture;
  Image<float> contrast;
  Image<float> fattening_weight;  // May be empty: 1 everywhere.
  AlignedPrior prior;             // May be empty.
  Intrinsics intrinsics;          // Of the raster.
  DepthResolution resolution;
};

struct GatheredEvidence {
  // Without `color` and `flags`, which the caller sets.
  ViewEvidence evidence;
  // The number of planes of regions, which are its first candidates.
  int num_region_planes = 0;
};

// The measurements to which a prior is aligned: those with texture of their
// own. On bare surfaces whole areas share errors, in all views alike, and a
// prior would follow them. The arguments are those of EvidenceInputs.
Image<RayDepth> SamplesToAlignBy(Image<RayDepth> samples,
                                 const Image<float>& texture,
                                 const Image<float>& fattening_weight);

// The standard deviation of measurements at their superpixels' planes, in
// relative depths of one pixel of disparity; 0 where no superpixel has a plane.
float MeasureNoise(const EvidenceInputs& inputs);

GatheredEvidence GatherEvidence(const EvidenceInputs& inputs,
                                const EvidenceOptions& options);

}  // namespace tsar
