// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/stages/label_components.h"

#include "colmap_tsar/device/connected_components.h"

#include <cmath>

namespace tsar {
namespace {

struct ContinuousDepth {
  const float* depth;

  TSAR_HD bool Contains(int i) const { return depth[i] > 0.f; }
  TSAR_HD bool Connected(int i, int j) const {
    return fabsf(depth[i] - depth[j]) < 0.01f * depth[i];
  }
};

}  // namespace

DeviceImage<int> LabelContinuousDepth(ImageView<const float> depth,
                                      Device& device) {
  DeviceImage<int> labels(device, depth.width, depth.height);
  LabelComponents(
      device, ContinuousDepth{depth.data}, Connectivity::kEight, labels.View());
  return labels;
}

}  // namespace tsar
