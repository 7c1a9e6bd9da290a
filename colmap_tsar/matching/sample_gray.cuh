// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Bilinear interpolation by the texture units of a GPU: in NVIDIA's, positions
// are rounded to 1/256 of a pixel and the weights of the four pixels to 1/256,
// and the weighted mean is exact. A CPU computes the same bits.

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/matching/gray_texture.h"

#include <cstdint>
#include <cstring>

namespace tsar {

// Samples many positions on the CPU, in texture coordinates: the middle of
// pixel (x, y) is at (x + 0.5, y + 0.5). Outside of the image its border is
// repeated; NaN counts as 0. Each step is done for all positions before the
// next one, in loops that compilers vectorize.
template <int kCount>
void SampleGrayBySteps(const GrayView& image,
                       const float (&x)[kCount],
                       const float (&y)[kCount],
                       float (&values)[kCount]) {
  // The left and upper neighbors, and the distance from them in 1/256 pixel;
  // the last pixel is only ever a right or lower neighbor.
  const int to_right = image.width > 1 ? 1 : 0;
  const int to_bottom = image.height > 1 ? 1 : 0;
  const int last_x = image.width - 1 - to_right;
  const int last_y = image.height - 1 - to_bottom;
  const auto max_x = static_cast<float>(image.width);
  const auto max_y = static_cast<float>(image.height);
  int index[kCount];
  int from_left[kCount];
  int from_top[kCount];
  const auto fixed = [](float position, float max, int size) {
    const float positive = position > 0.f ? position : 0.f;
    const float inside = positive < max ? positive : max;
    // Halves are rounded up.
    const int rounded = ((static_cast<int>(inside * 512.f) + 1) >> 1) - 128;
    const int last = 256 * (size - 1);
    return rounded < 0 ? 0 : rounded < last ? rounded : last;
  };
  for (int i = 0; i < kCount; ++i) {
    const int fixed_x = fixed(x[i], max_x, image.width);
    const int fixed_y = fixed(y[i], max_y, image.height);
    const int left = fixed_x >> 8 < last_x ? fixed_x >> 8 : last_x;
    const int top = fixed_y >> 8 < last_y ? fixed_y >> 8 : last_y;
    from_left[i] = fixed_x - 256 * left;
    from_top[i] = fixed_y - 256 * top;
    index[i] = top * image.pitch + left;
  }
  float top_left[kCount];
  float top_right[kCount];
  float bottom_left[kCount];
  float bottom_right[kCount];
  const int below = to_bottom * image.pitch;
  for (int i = 0; i < kCount; ++i) {
    const float* pixel = image.data + index[i];
    top_left[i] = pixel[0];
    top_right[i] = pixel[to_right];
    bottom_left[i] = pixel[below];
    bottom_right[i] = pixel[below + to_right];
  }
  for (int i = 0; i < kCount; ++i) {
    const int w11 = (from_left[i] * from_top[i] + 128) >> 8;
    const int w10 = from_left[i] - w11;
    const int w01 = from_top[i] - w11;
    const int w00 = 256 - from_left[i] - w01;
    values[i] = (static_cast<float>(w00) * top_left[i] +
                 static_cast<float>(w10) * top_right[i] +
                 static_cast<float>(w01) * bottom_left[i] +
                 static_cast<float>(w11) * bottom_right[i]) *
                (1.f / 256.f);
  }
}

// Samples one position on any device.
TSAR_HD inline float SampleGray(const GrayView& image, float x, float y) {
#ifdef __CUDA_ARCH__
  return tex2D<float>(image.texture, x, y);
#else
  const float all_x[1] = {x};
  const float all_y[1] = {y};
  float values[1];
  SampleGrayBySteps(image, all_x, all_y, values);
  return values[0];
#endif
}

}  // namespace tsar
