// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

namespace tsar {

// The depths, in the units of the maps, that the two ends of the colour scale
// stand for; 0 < nearest < farthest.
struct DepthRange {
  float nearest = 0.f;
  float farthest = 0.f;
};

// The range that holds the depths of both maps but for the smallest and the
// largest 2 %: wrong depths may be thousands of times too large, and would
// leave one colour for everything else. Pixels that are 0 (no depth) do not
// count. Any range, where neither map has a depth.
DepthRange RobustDepthRange(const Image<float>& before,
                            const Image<float>& after);

// Near is red, far is blue, 0 is black. Depths outside of the range have the
// colour of its end.
Image<Rgb> ColorizeDepth(const Image<float>& depth, const DepthRange& range);

}  // namespace tsar
