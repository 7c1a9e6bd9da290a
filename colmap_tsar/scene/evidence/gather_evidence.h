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
  // Grey levels of standard deviation above which a measurement counts in full,
  // and what one on weaker texture counts.
  float min_texture = 1.f;
  float confidence_without_texture = 0.5f;
  // Measurements count by the square of their fattening weight, too, but
  // by no less than this, above 0, where the pattern is not the pixel's own.
  float min_own_confidence = 0.02f;
  // What a pixel counts that was not measured, but lies in a region that has a
  // plane.
  float confidence_of_region_plane = 0.3f;
  // It counts less where measurements in the same superpixel lie off the plane:
  // further than this, as a multiple of RelativeDepthError().
  float max_region_plane_residual = 6.f;
  // What a pixel counts whose depth a prior tells, where none of this is known:
  // errors of priors are those of whole surfaces.
  float confidence_of_prior = 0.1f;
  // The error of a prior at which it still speaks for a plane, in its standard
  // deviations; and that of measurements, in expected ones.
  float prior_tolerance = 2.f;
  float tolerance = 1.f;
  int max_observations_per_superpixel = 32;
  int max_priors_per_superpixel = 12;
  int max_confirmed_per_superpixel = 12;
  // The weight of a pair of pixels across a border is
  // base + contrast exp(-edge / scale), edge in grey levels.
  float border_base = 0.05f;
  float border_contrast = 2.f;
  float border_scale = 4.f;
};

// What the stages found in one view, on the raster of its superpixels.
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
  // Without `color` and `ratings`, to which this would add nothing.
  ViewEvidence evidence;
  // How many of its candidates, which are the first, are planes of regions.
  int num_region_planes = 0;
};

// The spread of measurements about their superpixels' planes, in relative
// depths of one pixel of disparity; 0 where no superpixel has a plane.
float MeasureNoise(const EvidenceInputs& inputs);

GatheredEvidence GatherEvidence(const EvidenceInputs& inputs,
                                const EvidenceOptions& options);

}  // namespace tsar
