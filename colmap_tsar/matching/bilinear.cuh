// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/matching/gray_pair.h"

#include <cmath>
#include <cstdint>
#include <cstring>

// Bilinear interpolation of gray levels, in units of kGrayUnit. Positions
// outside are clamped to the border; NaN counts as 0.
namespace tsar {

// Clamps a column or row to [0, count - 1]; fmin and fmax are instructions on a
// GPU but calls on a CPU, where comparisons are used.
TSAR_HD inline float ClampPosition(float position, int count) {
  const float last = static_cast<float>(count - 1);
#ifdef __CUDA_ARCH__
  return fminf(fmaxf(position, 0.f), last);
#else
  const float positive = position > 0.f ? position : 0.f;
  return positive < last ? positive : last;
#endif
}

TSAR_HD inline float SampleBilinear(const ImageView<const float>& image,
                                    float x,
                                    float y) {
  x = ClampPosition(x, image.width);
  y = ClampPosition(y, image.height);
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const int x1 = x0 + 1 < image.width ? x0 + 1 : x0;
  const int y1 = y0 + 1 < image.height ? y0 + 1 : y0;
  const float fx = x - x0;
  const float fy = y - y0;
  const float top = image(x0, y0) + fx * (image(x1, y0) - image(x0, y0));
  const float bottom = image(x0, y1) + fx * (image(x1, y1) - image(x0, y1));
  return top + fy * (bottom - top);
}

// The two halves of a word as numbers.
struct Halves {
  float low;
  float high_minus_low;
};

TSAR_HD inline Halves SplitWord(uint32_t word) {
#ifdef __CUDA_ARCH__
  // The halves become the last bits of 2^23: a permutation and a subtraction
  // are faster than a conversion.
  const float low = __uint_as_float(__byte_perm(word, 0x4B000000u, 0x7410));
  const float high = __uint_as_float(__byte_perm(word, 0x4B000000u, 0x7432));
  return {low - 8388608.f, high - low};
#else
  const int low = static_cast<int>(word & 0xFFFFu);
  const int high = static_cast<int>(word >> 16);
  return {static_cast<float>(low), static_cast<float>(high - low)};
#endif
}

TSAR_HD inline float SampleBilinear(const ImageView<const GrayPair>& image,
                                    float x,
                                    float y) {
  x = ClampPosition(x, image.width);
  y = ClampPosition(y, image.height);
  // The pixel at most one to the left, and the row at most one above that has a
  // row below. For integer positions either neighbor may result, with weight 0
  // or 1.
  const int last_row = image.height > 1 ? image.height - 2 : 0;
  const float left = (x - 0.5f) + kRounder;
  const float above =
      fminf((y - 0.5f) + kRounder, kRounder + static_cast<float>(last_row));
  const float fx = x - (left - kRounder);
  const float fy = y - (above - kRounder);
  const GrayPair* pair =
      image.data +
      (IntegerBesideRounder(above) * image.width + IntegerBesideRounder(left));
  const Halves top = SplitWord(pair->word);
  const Halves bottom =
      SplitWord(pair[image.height > 1 ? image.width : 0].word);
  const float t = top.low + fx * top.high_minus_low;
  const float b = bottom.low + fx * bottom.high_minus_low;
  return t + fy * (b - t);
}

// Bit-identical sampling of many positions on the CPU: each step is done for
// all positions before the next one, in loops that compilers vectorize.
template <int kCount>
void SampleBilinearBySteps(const ImageView<const float>& image,
                           const float (&x)[kCount],
                           const float (&y)[kCount],
                           float (&values)[kCount]) {
  const int last_x = image.width - 1;
  const int last_y = image.height - 1;
  int x0[kCount];
  int y0[kCount];
  float fx[kCount];
  float fy[kCount];
  // Negative if any position lies in the last column or row.
  int room = 0;
  for (int i = 0; i < kCount; ++i) {
    const float inside_x = ClampPosition(x[i], image.width);
    const float inside_y = ClampPosition(y[i], image.height);
    x0[i] = static_cast<int>(inside_x);
    y0[i] = static_cast<int>(inside_y);
    fx[i] = inside_x - x0[i];
    fy[i] = inside_y - y0[i];
    room |= (last_x - 1 - x0[i]) | (last_y - 1 - y0[i]);
  }
  struct Neighbors {
    float left;
    float right;
  };
  Neighbors top[kCount];
  Neighbors bottom[kCount];
  if (room >= 0) {
    for (int i = 0; i < kCount; ++i) {
      const float* pixel = image.data + image.Index(x0[i], y0[i]);
      std::memcpy(&top[i], pixel, sizeof(Neighbors));
      std::memcpy(&bottom[i], pixel + image.width, sizeof(Neighbors));
    }
  } else {
    for (int i = 0; i < kCount; ++i) {
      const int x1 = x0[i] < last_x ? x0[i] + 1 : x0[i];
      const int y1 = y0[i] < last_y ? y0[i] + 1 : y0[i];
      top[i] = {image(x0[i], y0[i]), image(x1, y0[i])};
      bottom[i] = {image(x0[i], y1), image(x1, y1)};
    }
  }
  for (int i = 0; i < kCount; ++i) {
    const float t = top[i].left + fx[i] * (top[i].right - top[i].left);
    const float b = bottom[i].left + fx[i] * (bottom[i].right - bottom[i].left);
    values[i] = t + fy[i] * (b - t);
  }
}

template <int kCount>
void SampleBilinearBySteps(const ImageView<const GrayPair>& image,
                           const float (&x)[kCount],
                           const float (&y)[kCount],
                           float (&values)[kCount]) {
  const float last_row =
      kRounder + static_cast<float>(image.height > 1 ? image.height - 2 : 0);
  const int to_bottom = image.height > 1 ? image.width : 0;
  int index[kCount];
  float fx[kCount];
  float fy[kCount];
  for (int i = 0; i < kCount; ++i) {
    const float inside_x = ClampPosition(x[i], image.width);
    const float inside_y = ClampPosition(y[i], image.height);
    const float left = (inside_x - 0.5f) + kRounder;
    const float nearest = (inside_y - 0.5f) + kRounder;
    const float above = nearest < last_row ? nearest : last_row;
    fx[i] = inside_x - (left - kRounder);
    fy[i] = inside_y - (above - kRounder);
    index[i] =
        IntegerBesideRounder(above) * image.width + IntegerBesideRounder(left);
  }
  uint32_t top[kCount];
  uint32_t bottom[kCount];
  for (int i = 0; i < kCount; ++i) {
    top[i] = image.data[index[i]].word;
    bottom[i] = image.data[index[i] + to_bottom].word;
  }
  for (int i = 0; i < kCount; ++i) {
    const Halves above = SplitWord(top[i]);
    const Halves below = SplitWord(bottom[i]);
    const float t = above.low + fx[i] * above.high_minus_low;
    const float b = below.low + fx[i] * below.high_minus_low;
    values[i] = t + fy[i] * (b - t);
  }
}

}  // namespace tsar
