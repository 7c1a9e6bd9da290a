// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/texture_measures.h"

#include "colmap_tsar/device/parallel_for.h"

#include <cmath>

namespace tsar {
namespace {

// Calls body(grey level) for the pixels around (x, y).
template <typename Body>
TSAR_HD void ForWindow(
    ImageView<const float> gray, int x, int y, int radius, const Body& body) {
  for (int v = y - radius; v <= y + radius; ++v) {
    for (int u = x - radius; u <= x + radius; ++u) {
      if (gray.Contains(u, v)) {
        body(gray(u, v));
      }
    }
  }
}

struct TextureKernel {
  ImageView<const float> gray;
  ImageView<float> texture;

  TSAR_HD void operator()(int x, int y) const {
    const float middle = gray(x, y);
    int count = 0;
    float sum = 0.f;
    float sum_of_squares = 0.f;
    // Relative to the middle: the squares of grey levels as such would take
    // away the digits in which flat windows differ.
    ForWindow(gray, x, y, 3, [&](float level) {
      const float difference = level - middle;
      ++count;
      sum += difference;
      sum_of_squares += difference * difference;
    });
    const float mean = sum / count;
    texture(x, y) = sqrtf(fmaxf(sum_of_squares / count - mean * mean, 0.f));
  }
};

struct ContrastKernel {
  ImageView<const float> gray;
  ImageView<float> contrast;

  TSAR_HD void operator()(int x, int y) const {
    float low = gray(x, y);
    float high = low;
    ForWindow(gray, x, y, 1, [&](float level) {
      low = fminf(low, level);
      high = fmaxf(high, level);
    });
    contrast(x, y) = high - low;
  }
};

}  // namespace

DeviceImage<float> ComputeTexture(ImageView<const float> gray, Device& device) {
  DeviceImage<float> texture(device, gray.width, gray.height);
  ParallelFor(
      device, gray.width, gray.height, TextureKernel{gray, texture.View()});
  return texture;
}

DeviceImage<float> ComputeContrast(ImageView<const float> gray,
                                   Device& device) {
  DeviceImage<float> contrast(device, gray.width, gray.height);
  ParallelFor(
      device, gray.width, gray.height, ContrastKernel{gray, contrast.View()});
  return contrast;
}

}  // namespace tsar
