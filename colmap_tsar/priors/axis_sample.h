// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <vector>

namespace tsar {

// The two rows or columns of a raster between which one of another raster of
// the same photo lies; beyond the outermost both are that one.
struct AxisSample {
  int first = 0;
  int second = 0;
  float share = 0.f;  // Of the second, in [0, 1].

  // That of row or column i of `size` among `other_size`.
  TSAR_HD static AxisSample At(int i, int other_size, int size) {
    const float at = (i + 0.5f) * other_size / size - 0.5f;
    const float position = at > 0.f ? at : 0.f;
    const int last = other_size - 1;
    const int below = static_cast<int>(position);
    const int first = below < last ? below : last;
    const float share = position - static_cast<float>(first);
    return {first, first < last ? first + 1 : last, share < 1.f ? share : 1.f};
  }

  TSAR_HD int Nearest() const { return share < 0.5f ? first : second; }
};

// Those of all `size` rows or columns.
inline std::vector<AxisSample> AxisSamples(int other_size, int size) {
  std::vector<AxisSample> samples;
  for (int i = 0; i < size; ++i) {
    samples.push_back(AxisSample::At(i, other_size, size));
  }
  return samples;
}

}  // namespace tsar
