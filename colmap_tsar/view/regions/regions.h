// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"

#include <cstdint>

namespace tsar {

// 4-connected areas between the edges. With eight neighbors a region would leak
// through the corners of a diagonal line one pixel wide.
struct Regions {
  DeviceImage<int> labels;  // in [0, count), -1 on edges and in small areas
  int count = 0;
};

// Finds areas of more than min_size pixels, in the order of their first pixel.
// edges: nonzero on edges.
Regions FindRegions(ImageView<const uint8_t> edges,
                    int min_size,
                    Device& device);

// Gives the pixels without a label the smallest label among their four
// neighbors, num_steps times over: each region grows by that many pixels and
// never into another one.
DeviceImage<int> GrowLabels(ImageView<const int> labels,
                            int num_steps,
                            Device& device);

// Takes the label from pixels that have a neighbor with another label or none,
// num_steps times over: each region shrinks by that many pixels. The border of
// the image is no neighbor.
DeviceImage<int> ShrinkLabels(ImageView<const int> labels,
                              int num_steps,
                              Device& device);

}  // namespace tsar
