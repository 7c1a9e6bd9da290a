// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"

namespace tsar {

// LabelComponents over a whole depth map: 8-connected pixels whose depths
// differ by less than 1 %. Pixels without depth get -1.
DeviceImage<int> LabelContinuousDepth(ImageView<const float> depth,
                                      Device& device);

}  // namespace tsar
