// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"

namespace tsar {

constexpr int kNumSlicIterations = 8;

struct Superpixels {
  DeviceImage<int> labels;  // in [0, count)
  int count = 0;
};

// Simple linear iterative clustering with the distance of Eq. 3,
// D'^2 = (d_c / 10)^2 + (d_s / 20)^2 + n_avr, where n_avr is the mean
// aggregated score of the cluster: badly matched clusters attract more pixels.
// Every superpixel is 4-connected and holds at least a quarter of
// superpixel_size and ten pixels, unless the whole image is smaller.
// color: 0-255; score: n_aggr, same size; superpixel_size, S_sp: in pixels.
Superpixels ComputeSuperpixels(ImageView<const Rgb> color,
                               ImageView<const float> score,
                               int superpixel_size,
                               Device& device);

// Relabels nonnegative labels so that segments are 4-connected and have at
// least min_size pixels: in each round, every smaller segment is merged into
// its largest adjacent one, among equals the one whose first pixel comes first.
// Labels become 0 ... count - 1 in the order of first pixels. Returns count.
int MergeFragments(DeviceImage<int>& labels, int min_size, Device& device);

}  // namespace tsar
