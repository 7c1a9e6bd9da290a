// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/discovery/plane_support.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/labeling/label_inputs.h"

#include <vector>

namespace tsar {

// The unary cost of one superpixel on one plane, and measures of its evidence.
struct PlaneCost {
  float cost = 0.f;
  // Inliers of the plane, as a share of all observations.
  float explained = 0.f;
  // How strongly measurements support the plane, from 0 to 1: the share of
  // inliers, less where there are few. Depths that come from the plane of a
  // region do not count.
  float strength = 0.f;
  // Pixels that other views confirm, as a share of those tested.
  float confirmed = 0.f;
  // The uncertainty of the plane's depth there, from 0 to 1: by the plane's
  // variances, and where it was observed on one side only.
  float uncertainty = 0.f;
};

// The unary cost of each superpixel of the reference (row) on each plane
// (column), without votes of other views. inputs: with confident depths;
// planes: in the reference camera's frame, with their support.
Image<PlaneCost> ComputePlaneCosts(const LabelInputs& inputs,
                                   const std::vector<Plane>& planes,
                                   const PlaneSupport& support,
                                   const LabelOptions& options,
                                   Device& device);

}  // namespace tsar
