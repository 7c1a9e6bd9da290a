// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <memory>

namespace tsar {

// Whether maps have so few holes that no filter has removed what follows from a
// prior or from chance.
bool IsUnfiltered(int64_t num_depths, int64_t num_pixels);

// Tells the depths of such a map that the images confirm from the others. As
// views agree on a prior as well, a source confirms a depth if its own map
// agrees and its image matches better there than beside (see
// AddDistinctMatches); two sources have to, or the only one.
class UnmatchedDepths {
 public:
  // The view must outlive this object and have its camera, colours, depths and
  // normals.
  UnmatchedDepths(const ViewData& view, int num_sources);

  // Needs the source's camera, colours and depths.
  void CompareWith(const ViewData& source);

  // Makes pixels without a hypothesis of those to refine that too few of the
  // sources have confirmed. view: the one given before.
  void Drop(ViewData* view) const;

 private:
  const ViewData& view_;
  const int min_num_matches_;
  const std::unique_ptr<Device> device_;
  const Image<float> gray_;
  Image<uint8_t> num_matches_;
};

// With the reading of one source, whose photo has num_image_pixels.
int64_t UnmatchedDepthsWorkingBytes(int64_t num_pixels,
                                    int64_t num_image_pixels);

}  // namespace tsar
