// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace tsar {

// The mean of kSamples x kSamples samples of a drawn pixel, sample(column,
// row). No detail of drawings lies between the four outermost ones, so if these
// are equal the others are skipped.
template <int kSamples, typename Sample>
double PixelMean(const Sample& sample) {
  constexpr int kLast = kSamples - 1;
  const double first = sample(0, 0);
  if (sample(kLast, 0) == first && sample(0, kLast) == first &&
      sample(kLast, kLast) == first) {
    return first;
  }
  double sum = 0.0;
  for (int row = 0; row < kSamples; ++row) {
    for (int column = 0; column < kSamples; ++column) {
      sum += sample(column, row);
    }
  }
  return sum / (kSamples * kSamples);
}

}  // namespace tsar
