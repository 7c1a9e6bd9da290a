// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"

namespace tsar {

// Converts sRGB to CIELAB (white point D65), in which distances are about
// perceptual: x = L in [0, 100], y = a and z = b around 0. The result is
// bit-identical on every device.
DeviceImage<Vec3f> ConvertToLab(ImageView<const Rgb> color, Device& device);

}  // namespace tsar
