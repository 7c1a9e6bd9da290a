// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Bilinear interpolation by the texture units of a GPU. In NVIDIA's positions
// are rounded to 1/256 of a pixel (CUDA C++ Programming Guide, "Linear
// Filtering"); on an H200 the weights of the four pixels are multiples of
// 1/256, too, and their mean is exact. A CPU computes the same bits.

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
  struct Neighbors {
    float left;
    float right;
  };
  // Positions in 1/256 pixel from the middle of the first one; halves are
  // rounded up.
  const auto fixed = [](float position, float last) {
    const float positive = position > 0.5f ? position : 0.5f;
    const float inside = positive < last ? positive : last;
    return ((static_cast<int>(inside * 512.f) + 1) >> 1) - 128;
  };
  const auto max_x = static_cast<float>(image.width) - 0.5f;
  const auto max_y = static_cast<float>(image.height) - 0.5f;
  // The last pixel is only ever a right or lower neighbor.
  const int last_left = image.width > 1 ? image.width - 2 : 0;
  const int last_top = image.height > 1 ? image.height - 2 : 0;
  int index[kCount];
  int from_left[kCount];
  int from_top[kCount];
  for (int i = 0; i < kCount; ++i) {
    const int fixed_x = fixed(x[i], max_x);
    const int fixed_y = fixed(y[i], max_y);
    const int left = fixed_x >> 8 < last_left ? fixed_x >> 8 : last_left;
    const int top = fixed_y >> 8 < last_top ? fixed_y >> 8 : last_top;
    from_left[i] = fixed_x - 256 * left;
    from_top[i] = fixed_y - 256 * top;
    index[i] = top * image.pitch + left;
  }
  Neighbors top[kCount];
  Neighbors bottom[kCount];
  const int below = image.height > 1 ? image.pitch : 0;
  for (int i = 0; i < kCount; ++i) {
    const float* pixel = image.data + index[i];
    std::memcpy(&top[i], pixel, sizeof(Neighbors));
    std::memcpy(&bottom[i], pixel + below, sizeof(Neighbors));
  }
  for (int i = 0; i < kCount; ++i) {
    const int w11 = (from_left[i] * from_top[i] + 128) >> 8;
    const int w10 = from_left[i] - w11;
    const int w01 = from_top[i] - w11;
    const int w00 = 256 - from_left[i] - w01;
    values[i] = (static_cast<float>(w00) * top[i].left +
                 static_cast<float>(w10) * top[i].right +
                 static_cast<float>(w01) * bottom[i].left +
                 static_cast<float>(w11) * bottom[i].right) *
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
