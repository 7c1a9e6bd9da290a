// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// The taps of the filters F_A and F_B and their weights (Eq. 6).

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/superpixels/weighted_median.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tsar {

constexpr int kTapRadius = 5;
constexpr int kTapSide = 2 * kTapRadius + 1;
constexpr int kNumTaps = kTapSide * kTapSide;
// Taps that weigh less than this do not count.
constexpr float kMinTapWeight = 1e-3f;

// The weights of 11 x 11 taps, `stride` pixels apart, for use in a kernel.
struct BilateralKernel {
  int stride = 1;
  // exp(-distance / alpha^2) by the distance in columns and rows.
  float spatial[kTapRadius + 1][kTapRadius + 1];
  // exp(-difference / beta^2) by the squared difference of colors, as long as
  // it is at least kMinTapWeight.
  const float* color = nullptr;
  int num_colors = 0;

  // 0 where the colors differ too much to count. column and row in
  // [-kTapRadius, kTapRadius].
  TSAR_HD float Weight(int column, int row, const Rgb& a, const Rgb& b) const {
    const int dr = a.r - b.r;
    const int dg = a.g - b.g;
    const int db = a.b - b.b;
    const int squared = dr * dr + dg * dg + db * db;
    if (squared >= num_colors) {
      return 0.f;
    }
    const float weight =
        color[squared] *
        spatial[row < 0 ? -row : row][column < 0 ? -column : column];
    return weight < kMinTapWeight ? 0.f : weight;
  }
};

// Holds the table of colors that the taps refer to.
class BilateralKernelTable {
 public:
  BilateralKernelTable(const WeightedMedianOptions& options, Device& device)
      : color_(device, MakeColorTable(options.color_sigma)) {
    taps_.stride =
        std::max(1, static_cast<int>(std::lround(options.radius / kTapRadius)));
    const float sigma = options.spatial_sigma;
    for (int row = 0; row <= kTapRadius; ++row) {
      for (int column = 0; column <= kTapRadius; ++column) {
        taps_.spatial[row][column] = std::exp(
            -std::sqrt(static_cast<float>(row * row + column * column)) /
            (sigma * sigma));
      }
    }
    taps_.color = color_.Data();
    taps_.num_colors = static_cast<int>(color_.Size());
  }

  const BilateralKernel& Taps() const { return taps_; }

 private:
  static int NumColors(float sigma) {
    const float limit = -std::log(kMinTapWeight) * sigma * sigma;
    return static_cast<int>(std::min(limit * limit, 3.f * 255.f * 255.f)) + 1;
  }
  static std::vector<float> MakeColorTable(float sigma) {
    const int size = NumColors(sigma);
    std::vector<float> table(size);
    for (int i = 0; i < size; ++i) {
      table[i] = std::exp(-std::sqrt(static_cast<float>(i)) / (sigma * sigma));
    }
    return table;
  }

  Buffer<float> color_;
  BilateralKernel taps_;
};

}  // namespace tsar
