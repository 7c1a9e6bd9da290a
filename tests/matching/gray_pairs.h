// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/matching/gray_pair.h"

#include "tests/support/for_each_pixel.h"

namespace tsar {

// The image as sources have it, in host memory.
inline Image<GrayPair> PairsOf(const Image<float>& gray) {
  Image<GrayPair> pairs(gray.Width(), gray.Height());
  ForEachPixel(gray.Width(), gray.Height(), [&](int x, int y) {
    const int right = x + 1 < gray.Width() ? x + 1 : x;
    pairs(x, y) = MakeGrayPair(gray(x, y), gray(right, y));
  });
  return pairs;
}

// Their gray levels, as they are after the rounding.
inline Image<float> LevelsOf(const Image<GrayPair>& pairs) {
  Image<float> gray(pairs.Width(), pairs.Height());
  for (size_t i = 0; i < gray.NumPixels(); ++i) {
    gray.Data()[i] = static_cast<float>(pairs.Data()[i].word & 0xFFFFu) *
                     kGrayUnit<GrayPair>;
  }
  return gray;
}

}  // namespace tsar
