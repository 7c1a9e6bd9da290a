// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"

namespace tsar {

// CIELAB of sRGB colours under the white of D65: x = L in [0, 100], y = a and
// z = b around 0, in which distances are about those that the eye sees. The
// same bits on every device.
DeviceImage<Vec3f> ConvertToLab(ImageView<const Rgb> color, Device& device);

}  // namespace tsar
