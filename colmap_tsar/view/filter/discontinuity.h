// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/device/buffer.h"

namespace tsar {

struct DiscontinuityOptions {
  // Layers k = 1 ... num_layers, each half as wide as the one before.
  int num_layers = 3;
  // t_d = max_step * 2^k: neighbors closer in disparity are connected (paper
  // pixels).
  float max_step = 3.f;
  // t_n = min_size * 2^k: components with more pixels of their layer are kept.
  int min_size = 5;
};

// n_disp, the disparity discontinuity confidence: the sum over the layers k of
// 1 / k where the pixel belongs to a component of continuous disparity that is
// large enough. In [0, 11/6] for three layers; isolated peaks get 0.
// depth: z, 0 = invalid (gets 0).
DeviceImage<float> ComputeDiscontinuity(ImageView<const float> depth,
                                        const DisparityScale& scale,
                                        const DiscontinuityOptions& options,
                                        Device& device);

}  // namespace tsar
