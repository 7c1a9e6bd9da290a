// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/evidence/observed_view.h"

#include <vector>

namespace tsar {

// Connected components of superpixels without a color step between them.
struct ColorRegions {
  std::vector<int> of_superpixel;  // In [0, count).
  int count = 0;
};

// Regions of three levels, each made of those of the level before. Neighbors
// are merged in ascending order of the mean step across their whole common
// border, up to 2, 4 and 8 gray levels over the three channels: a border that
// fades in places still separates, and a shaded wall is one region. The level
// at which a surface is one region is not known beforehand. No region crosses a
// crease (ObservedView::sides).
std::vector<ColorRegions> FindColorRegions(const ObservedView& view);

}  // namespace tsar
