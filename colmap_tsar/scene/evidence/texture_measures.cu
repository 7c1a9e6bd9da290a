// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/texture_measures.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/view/denoise/window_variance.h"

#include <cmath>

namespace tsar {
namespace {

struct TextureKernel {
  ImageView<const float> gray;
  ImageView<float> texture;

  TSAR_HD void operator()(int x, int y) const {
    texture(x, y) = sqrtf(fmaxf(WindowVariance(gray, x, y, 3), 0.f));
  }
};

struct ContrastKernel {
  ImageView<const float> gray;
  ImageView<float> contrast;

  TSAR_HD void operator()(int x, int y) const {
    float low = gray(x, y);
    float high = low;
    for (int v = y - 1; v <= y + 1; ++v) {
      for (int u = x - 1; u <= x + 1; ++u) {
        if (gray.Contains(u, v)) {
          low = fminf(low, gray(u, v));
          high = fmaxf(high, gray(u, v));
        }
      }
    }
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
