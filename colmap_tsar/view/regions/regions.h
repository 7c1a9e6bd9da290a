// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"

#include <cstdint>

namespace tsar {

// 4-connected areas between the edges. Four neighbours, because eight would let
// a region leak through the corners of a diagonal line one pixel wide.
struct Regions {
  DeviceImage<int> labels;  // in [0, count), -1 on edges and in small areas
  int count = 0;
};

// Areas of more than min_size pixels, numbered by their first pixel.
// edges: other than 0 on edges.
Regions FindRegions(ImageView<const uint8_t> edges,
                    int min_size,
                    Device& device);

// The pixels off the edges in each connected part of a segment, where there are
// more than min_size of them, numbered alike. Edges do not divide them.
// segments: 0 for none.
Regions FindSegments(ImageView<const uint16_t> segments,
                     ImageView<const uint8_t> edges,
                     int min_size,
                     Device& device);

// Gives the pixels without a label the smallest label among their four
// neighbours, num_steps times over: each region grows by that many pixels and
// never into another one.
DeviceImage<int> GrowLabels(ImageView<const int> labels,
                            int num_steps,
                            Device& device);

// Takes the label from pixels that have a neighbour with another label or none,
// num_steps times over: each region shrinks by that many pixels. The border of
// the image is no neighbour.
DeviceImage<int> ShrinkLabels(ImageView<const int> labels,
                              int num_steps,
                              Device& device);

// How many it can find.
int64_t MaxRegions(int64_t num_pixels, int min_size);

}  // namespace tsar
