// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/view_data.h"

namespace tsar {

size_t ViewData::NumBytes() const {
  return color.NumPixels() * sizeof(Rgb) + depth.NumPixels() * sizeof(float) +
         normal.NumPixels() * sizeof(Vec3f) +
         (min_cost.NumPixels() + second_cost.NumPixels()) * sizeof(float);
}

}  // namespace tsar
