// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <vector>

namespace tsar {

// A part of an axis.
struct HeightRange {
  double min = 0.0;
  double max = 0.0;
};

// The longest part of an axis at which at least min_views views see something;
// empty where there is none. heights: by view, those at which it sees it,
// either ascending or descending. bin: the length that counts as one height;
// gaps of a few bins in one view are closed.
HeightRange LongestCommonHeights(
    const std::vector<std::vector<double>>& heights,
    double bin,
    size_t min_views);

}  // namespace tsar
