// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/discovery/plane_support.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/labeling/label_inputs.h"

#include <cstdint>
#include <vector>

namespace tsar {

// What the costs of one superpixel on one plane were made of.
struct PlaneCost {
  float cost = 0.f;
  // Observations on the plane, as a share of all.
  float explained = 0.f;
  // How firmly measurements place the superpixel on the plane, from 0 to 1: the
  // share of them that lie on it, less where there are few. Depths that come
  // from the plane of a region are none.
  float strength = 0.f;
  // Pixels that other views confirm, as a share of those tested.
  float confirmed = 0.f;
  // How little is known of the plane's depth there, from 0 to 1: by the spread
  // of its observations, and where it was observed on one side only.
  float uncertainty = 0.f;
};

// The cost of each superpixel of the reference (row) on each plane (column),
// neighbours and the labels of other views left aside. inputs: with confident
// depths; planes: in the reference camera's frame, with their support.
Image<PlaneCost> ComputePlaneCosts(const LabelInputs& inputs,
                                   const std::vector<Plane>& planes,
                                   const PlaneSupport& support,
                                   const LabelOptions& options,
                                   Device& device);

// What a superpixel costs that has no plane. weight: see ViewEvidence.
float UnlabelledCost(float weight,
                     float num_pixels,
                     const LabelOptions& options);

}  // namespace tsar
