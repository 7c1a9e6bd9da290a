// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/evidence/observed_view.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tsar {

// The superpixels of other views that show the surface observed by a
// superpixel. Superpixels are indexed across all views, as in
// ObservationTable.
class SuperpixelMatches {
 public:
  // One of a superpixel's observations is projected into each other view. It
  // matches the superpixel there if the median depth of that superpixel's
  // observations is within 4 % of its own: an occluder is no evidence. A view
  // without a raster of superpixels has no matches.
  explicit SuperpixelMatches(const std::vector<ObservedView>& views);

  // The matches of a superpixel, at most one per other view.
  std::span<const int> Of(int superpixel) const {
    const size_t begin = first_[superpixel];
    return {matches_.data() + begin, first_[superpixel + 1] - begin};
  }

 private:
  std::vector<int> matches_;
  std::vector<size_t> first_ = {0};  // Of each superpixel.
};

}  // namespace tsar
