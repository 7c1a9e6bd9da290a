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

// Clamps a position to [0, last]; fmin and fmax are instructions on a GPU but
// calls on a CPU, where comparisons are used.
TSAR_HD inline float Clamp(float position, float last) {
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
  x = Clamp(x, static_cast<float>(image.width - 1));
  y = Clamp(y, static_cast<float>(image.height - 1));
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

// Two neighbors in a row.
struct Halves {
  float low;
  float high_minus_low;
};

#ifdef __CUDA_ARCH__
// The halves of a word plus 2^23, of which they become the last bits: a
// permutation and a subtraction are faster than a conversion.
struct RaisedHalves {
  static constexpr float kRaise = 8388608.f;

  __device__ explicit RaisedHalves(uint32_t word)
      : low(__uint_as_float(__byte_perm(word, 0x4B000000u, 0x7410))),
        high(__uint_as_float(__byte_perm(word, 0x4B000000u, 0x7432))) {}

  float low;
  float high;
};
#endif

// The halves of a word as numbers, less an integer.
TSAR_HD inline Halves SplitWord(uint32_t word, float origin = 0.f) {
#ifdef __CUDA_ARCH__
  const RaisedHalves raised(word);
  return {raised.low - (RaisedHalves::kRaise + origin),
          raised.high - raised.low};
#else
  const int low = static_cast<int>(word & 0xFFFFu);
  const int high = static_cast<int>(word >> 16);
  return {static_cast<float>(low) - origin, static_cast<float>(high - low)};
#endif
}

TSAR_HD inline float Interpolate(const Halves& top,
                                 const Halves& bottom,
                                 float fx,
                                 float fy) {
  const float t = MultiplyAdd(fx, top.high_minus_low, top.low);
  const float b = MultiplyAdd(fx, bottom.high_minus_low, bottom.low);
  return MultiplyAdd(fy, b - t, t);
}

// The largest position with a row below it, if there are several rows: the last
// one has a weight of 0.999 and more there, with up to 8192 rows.
TSAR_HD inline float LastRowPosition(int height) {
  constexpr float kBelowOne = 1.f - 1.f / 16777216.f;
  return kBelowOne * static_cast<float>(height - 1);
}

// A sample less the origin, an integer that keeps sums of squares small.
TSAR_HD inline float SampleAbout(const ImageView<const GrayPair>& image,
                                 float x,
                                 float y,
                                 float origin) {
  x = Clamp(x, static_cast<float>(image.width - 1));
  y = Clamp(y, LastRowPosition(image.height));
  const float left = FloorPlusRounder(x);
  const float above = FloorPlusRounder(y);
  // The rounders are subtracted from the index: one instruction less.
  const auto width = static_cast<uint32_t>(image.width);
  const uint32_t index = static_cast<uint32_t>(BitsOf(above)) * width +
                         static_cast<uint32_t>(BitsOf(left)) -
                         static_cast<uint32_t>(kBitsOfRounder) * (width + 1u);
  const GrayPair* pair = image.data + static_cast<int32_t>(index);
  const float fx = x - (left - kRounder);
  const float fy = y - (above - kRounder);
  const int to_bottom = image.height > 1 ? image.width : 0;
  return Interpolate(SplitWord(pair->word, origin),
                     SplitWord(pair[to_bottom].word, origin),
                     fx,
                     fy);
}

TSAR_HD inline float SampleAbout(const ImageView<const float>& image,
                                 float x,
                                 float y,
                                 float origin) {
  return SampleBilinear(image, x, y) - origin;
}

TSAR_HD inline float SampleBilinear(const ImageView<const GrayPair>& image,
                                    float x,
                                    float y) {
  return SampleAbout(image, x, y, 0.f);
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
    const float inside_x = Clamp(x[i], static_cast<float>(last_x));
    const float inside_y = Clamp(y[i], static_cast<float>(last_y));
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
void SampleAboutBySteps(const ImageView<const GrayPair>& image,
                        const float (&x)[kCount],
                        const float (&y)[kCount],
                        float origin,
                        float (&values)[kCount]) {
  const auto last_x = static_cast<float>(image.width - 1);
  const float last_y = LastRowPosition(image.height);
  const int to_bottom = image.height > 1 ? image.width : 0;
  int index[kCount];
  float fx[kCount];
  float fy[kCount];
  for (int i = 0; i < kCount; ++i) {
    const float inside_x = Clamp(x[i], last_x);
    const float inside_y = Clamp(y[i], last_y);
    const auto left = static_cast<int>(inside_x);
    const auto above = static_cast<int>(inside_y);
    fx[i] = inside_x - static_cast<float>(left);
    fy[i] = inside_y - static_cast<float>(above);
    index[i] = above * image.width + left;
  }
  uint32_t top[kCount];
  uint32_t bottom[kCount];
  for (int i = 0; i < kCount; ++i) {
    top[i] = image.data[index[i]].word;
    bottom[i] = image.data[index[i] + to_bottom].word;
  }
  for (int i = 0; i < kCount; ++i) {
    values[i] = Interpolate(
        SplitWord(top[i], origin), SplitWord(bottom[i], origin), fx[i], fy[i]);
  }
}

template <int kCount>
void SampleAboutBySteps(const ImageView<const float>& image,
                        const float (&x)[kCount],
                        const float (&y)[kCount],
                        float origin,
                        float (&values)[kCount]) {
  SampleBilinearBySteps(image, x, y, values);
  for (float& value : values) {
    value -= origin;
  }
}

}  // namespace tsar
