// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/pipeline/gray.h"

namespace tsar {
namespace {

struct GrayKernel {
  ImageView<const Rgb> color;
  ImageView<float> gray;
  TSAR_HD void operator()(int64_t i) const {
    const Rgb c = color.data[i];
    gray.data[i] = 0.299f * c.r + 0.587f * c.g + 0.114f * c.b;
  }
};

}  // namespace

void ComputeGray(ImageView<const Rgb> color,
                 ImageView<float> gray,
                 Device& device) {
  ParallelFor(
      device, static_cast<int64_t>(color.NumPixels()), GrayKernel{color, gray});
}

DeviceImage<float> ComputeGray(ImageView<const Rgb> color, Device& device) {
  DeviceImage<float> gray(device, color.width, color.height);
  ComputeGray(color, gray.View(), device);
  return gray;
}

}  // namespace tsar
