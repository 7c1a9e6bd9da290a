// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/pipeline/compose.h"

#include <cstdint>

namespace tsar {

// Which plane of the scene each pixel of a composed map lies on.
// scene_planes: as the map was composed with. numbers: of its size, one more
// than the number of the plane in the model; 0 where that is not a plane of the
// model. Result, of the map's size: the number where the depth is exactly that
// of the plane, 0 elsewhere.
DeviceImage<uint16_t> MapPlanes(ImageView<const float> depth,
                                const PlaneRaster& scene_planes,
                                ImageView<const uint16_t> numbers,
                                Device& device);

}  // namespace tsar
