// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"

#include <cstdint>

namespace tsar {

// Edge pixels (1, others 0) of Roberts' operator: the root of the summed
// squares of the two diagonal differences exceeds threshold, in gray levels on
// 0-255.
DeviceImage<uint8_t> DetectRobertsEdges(ImageView<const Rgb> color,
                                        float threshold,
                                        Device& device);

// Edge pixels by Eq. 10 as printed, which takes the root of each gray level
// before the differences: their summed squares exceed threshold. With a
// threshold of 4, a step of 34 levels is needed at gray 128, and white walls
// have few edges.
DeviceImage<uint8_t> DetectEdgesOfRoots(ImageView<const Rgb> color,
                                        float threshold,
                                        Device& device);

}  // namespace tsar
