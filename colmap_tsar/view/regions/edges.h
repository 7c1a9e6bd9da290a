// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"

#include <cstdint>

namespace tsar {

// Edge pixels (1, others 0) of Roberts' operator (Eq. 10 without the roots of
// gray levels): the root of the summed squares of the two diagonal differences
// exceeds threshold, in gray levels on 0-255.
DeviceImage<uint8_t> DetectRobertsEdges(ImageView<const Rgb> color,
                                        float threshold,
                                        Device& device);

// The edges together with the straight segments through them, by a Hough
// transform: every edge pixel votes for all lines through it and then selects
// the one with most votes. If that has five, the line is followed from the
// first of adjacent pixels on it in both directions, over gaps of at most t_c =
// min(0.1 * length, max_gap), and the segment found is drawn, unless it is
// shorter than a thirtieth of the image's shorter side. Segments are
// 8-connected, which keeps 4-connected regions apart. Both images are nonzero
// on edges. max_gap, upsilon: in pixels.
DeviceImage<uint8_t> DrawLineSegments(ImageView<const uint8_t> edges,
                                      int max_gap,
                                      Device& device);

}  // namespace tsar
