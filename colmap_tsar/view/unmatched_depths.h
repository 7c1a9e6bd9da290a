// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <memory>

namespace tsar {

// Whether maps have so few holes that no filter has removed depths due to a
// prior or to chance.
bool IsUnfiltered(int64_t num_depths, int64_t num_pixels);

// Finds the depths of such a map that the images confirm. As views agree on a
// prior as well, a source confirms a depth if its own map agrees and its image
// matches better there than at nearby depths (see AddDistinctMatches); two
// sources must confirm, or the only one.
class UnmatchedDepths {
 public:
  // The view must outlive this object and have its camera, colors, depths and
  // normals.
  UnmatchedDepths(const ViewData& view, int num_sources);

  // Counts confirmations by a source with camera, colors and depths.
  void CompareWith(const ViewData& source);

  // Clears the hypotheses to refine that too few sources confirmed. view: the
  // one given to the constructor.
  void Drop(ViewData* view) const;

 private:
  const ViewData& view_;
  const int min_num_matches_;
  const std::unique_ptr<Device> device_;
  const Image<float> gray_;
  Image<uint8_t> num_matches_;
};

}  // namespace tsar
