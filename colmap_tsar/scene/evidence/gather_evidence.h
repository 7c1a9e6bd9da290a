// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/priors/align_prior.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <vector>

namespace tsar {

// The largest numbers of observations of a superpixel and of its depths that
// only other views confirm.
inline constexpr int kMaxObservationsPerSuperpixel = 32;
inline constexpr int kMaxConfirmedPerSuperpixel = 12;

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
  // The tolerance of measurements in relative depths of one pixel of disparity,
  // to which the errors of the prior are compared.
  float tolerance = 1.f;
};

struct GatheredEvidence {
  // Without `color` and `flags`, which the caller sets.
  ViewEvidence evidence;
  // The number of planes of regions, which are its first candidates.
  int num_region_planes = 0;
};

// The measurements to which a prior is aligned: those with texture of their
// own. On textureless surfaces whole areas share errors, in all views alike,
// and a prior would follow them. The arguments are those of EvidenceInputs.
Image<RayDepth> SamplesToAlignBy(Image<RayDepth> samples,
                                 const Image<float>& texture,
                                 const Image<float>& fattening_weight);

// The standard deviation of measurements at their superpixels' planes, in
// relative depths of one pixel of disparity; 0 where no superpixel has a plane.
float MeasureNoise(const EvidenceInputs& inputs);

GatheredEvidence GatherEvidence(const EvidenceInputs& inputs);

// The planes that a view's prior proposes: for each superpixel the plane that
// best fits the prior in it and in its neighbors that continue it. None without
// a prior.
std::vector<Plane> ProposePlanesOfPrior(const ViewEvidence& evidence);

}  // namespace tsar
