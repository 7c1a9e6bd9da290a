// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/roberts.h"

#include "colmap_tsar/device/parallel_for.h"

#include <cmath>

namespace tsar {
namespace {

struct RobertsKernel {
  ImageView<const Rgb> color;
  float min_gradient;  // Threshold of the squared differences.
  bool takes_roots;
  ImageView<uint8_t> edges;

  TSAR_HD float Gray(int x, int y) const {
    const Rgb& c = color(x, y);
    const float gray = 0.299f * c.r + 0.587f * c.g + 0.114f * c.b;
    return takes_roots ? sqrtf(gray) : gray;
  }

  TSAR_HD void operator()(int x, int y) const {
    // The last row and column repeat themselves.
    const int right = x + 1 < color.width ? x + 1 : x;
    const int below = y + 1 < color.height ? y + 1 : y;
    const float first = Gray(x, y) - Gray(right, below);
    const float second = Gray(right, y) - Gray(x, below);
    edges(x, y) = first * first + second * second > min_gradient ? 1 : 0;
  }
};

DeviceImage<uint8_t> Detect(ImageView<const Rgb> color,
                            float min_gradient,
                            bool takes_roots,
                            Device& device) {
  DeviceImage<uint8_t> edges(device, color.width, color.height);
  ParallelFor(device,
              color.width,
              color.height,
              RobertsKernel{color, min_gradient, takes_roots, edges.View()});
  return edges;
}

}  // namespace

DeviceImage<uint8_t> DetectRobertsEdges(ImageView<const Rgb> color,
                                        float threshold,
                                        Device& device) {
  return Detect(color, threshold * threshold, false, device);
}

DeviceImage<uint8_t> DetectEdgesOfRoots(ImageView<const Rgb> color,
                                        float threshold,
                                        Device& device) {
  return Detect(color, threshold, true, device);
}

}  // namespace tsar
