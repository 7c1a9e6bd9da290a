// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

namespace tsar {

// The cost of a window without evidence: its center leaves the source image, or
// one of the two windows is textureless. It is no evidence against the depth.
constexpr float kUndefinedCost = -1.f;
// Its value in cost maps, as COLMAP writes them.
constexpr float kCostWithoutEvidence = 2.f;

// The matching costs of each pixel's own plane; kUndefinedCost without
// evidence.
struct MatchingCosts {
  DeviceImage<float> min_cost;     // c_min: smallest 1 - NCC over the sources
  DeviceImage<float> second_cost;  // c_sec: second smallest
  // LRD of Eq. 1, in [0, 1]: |cost of the best source - cost of the same plane
  // with the window taken in that source and mapped back|.
  DeviceImage<float> left_right_difference;
};

// Evaluates each pixel's plane against every source by bilaterally weighted NCC
// (an 11 x 11 window, every second row and column, weights of the reference).
// Without sources everything is undefined.
MatchingCosts ComputeMatchingCosts(const ReferenceView& reference,
                                   const SourceViews& sources,
                                   Device& device);

}  // namespace tsar
