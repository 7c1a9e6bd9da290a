// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"

#include <cstdint>

namespace tsar {

// Edge pixels (1, others 0) of Roberts' operator: the root of the summed
// squares of the two diagonal differences exceeds threshold, in grey levels on
// 0-255. Eq. 10 takes the root of each grey level instead; then a step of 32
// levels would be needed at grey 128, and white walls would have no edges.
DeviceImage<uint8_t> DetectRobertsEdges(ImageView<const Rgb> color,
                                        float threshold,
                                        Device& device);

}  // namespace tsar
