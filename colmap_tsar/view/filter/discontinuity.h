// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/device/buffer.h"

namespace tsar {

// n_disp, the disparity discontinuity confidence: the sum over three layers k
// of 1 / k where the pixel belongs to a component of continuous disparity that
// is large enough. In [0, 11/6]; isolated peaks get 0.
// depth: z, 0 = invalid (gets 0).
DeviceImage<float> ComputeDiscontinuity(ImageView<const float> depth,
                                        const DisparityScale& scale,
                                        Device& device);

}  // namespace tsar
