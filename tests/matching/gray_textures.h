// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/gray_texture.h"

namespace tsar {

inline GrayTexture TextureOf(const Image<float>& gray, Device& device) {
  const DeviceImage<float> on_device(device, gray);
  return ComputeGrayTexture(on_device.View(), device);
}

}  // namespace tsar
