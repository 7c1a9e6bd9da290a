// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"

namespace tsar {

// The brightness of a colour image, 0-255, as matching sees it.
DeviceImage<float> ComputeGray(ImageView<const Rgb> color, Device& device);

}  // namespace tsar
