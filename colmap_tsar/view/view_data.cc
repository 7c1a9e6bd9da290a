// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/view_data.h"

namespace tsar {

size_t ViewData::NumBytes() const {
  return color.NumPixels() * sizeof(Rgb) + depth.NumPixels() * sizeof(float) +
         normal.NumPixels() * sizeof(Vec3f) +
         is_to_refine.NumPixels() * sizeof(uint8_t) +
         (min_cost.NumPixels() + second_cost.NumPixels()) * sizeof(float) +
         (prior ? prior->NumBytes() : 0) +
         segments.NumPixels() * sizeof(uint16_t);
}

int64_t ViewDataBytes(int64_t num_pixels, bool has_costs) {
  const size_t bytes_per_pixel = sizeof(Rgb) + sizeof(float) + sizeof(Vec3f) +
                                 sizeof(uint8_t) +
                                 (has_costs ? 2 * sizeof(float) : 0);
  return num_pixels * static_cast<int64_t>(bytes_per_pixel);
}

}  // namespace tsar
