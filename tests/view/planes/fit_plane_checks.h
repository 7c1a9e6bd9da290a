// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// What the tests of fits have in common.

#include "colmap_tsar/view/planes/fit_plane.h"

#include <gtest/gtest.h>

namespace tsar {

constexpr double kLossScale = 0.5;

inline void ExpectSame(const WorldPlane& a, const WorldPlane& b) {
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.offset, b.offset);
}

inline std::vector<DepthObservation> Scaled(
    std::vector<DepthObservation> observations, double scale) {
  for (DepthObservation& observation : observations) {
    observation.center *= scale;
    observation.depth *= scale;
    observation.sigma *= scale;
  }
  return observations;
}

inline FitSamples ToSamples(const std::vector<DepthObservation>& observations) {
  FitSamples samples;
  for (const DepthObservation& observation : observations) {
    samples.Add(observation);
  }
  return samples;
}

}  // namespace tsar
