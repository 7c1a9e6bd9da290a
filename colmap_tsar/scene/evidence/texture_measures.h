// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"

namespace tsar {

// Standard deviation of the gray levels (0-255) in the 7x7 pixels around each
// pixel, as far as they lie in the image.
DeviceImage<float> ComputeTexture(ImageView<const float> gray, Device& device);

// Largest minus smallest gray level in the 3x3 pixels around each pixel: the
// strength of an edge there.
DeviceImage<float> ComputeContrast(ImageView<const float> gray, Device& device);

}  // namespace tsar
