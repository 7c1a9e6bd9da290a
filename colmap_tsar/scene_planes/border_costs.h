// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/scene_planes/view_evidence.h"

#include <vector>

namespace tsar {

// What a border between two superpixels costs for each pair of labels, of which
// the last one is 'none'. Keeps a reference to the evidence.
class BorderCosts {
 public:
  // full_gap: see LabelOptions.
  BorderCosts(const ViewEvidence& evidence,
              const Intrinsics& intrinsics,
              const DepthResolution& resolution,
              const std::vector<Plane>& planes,
              float full_gap);

  // edge: the number of the border in the evidence.
  float operator()(int edge, int a, int b) const;

 private:
  const float* Depths(int edge, int plane) const {
    return depths_.data() +
           (static_cast<size_t>(edge) * static_cast<size_t>(num_planes_) +
            static_cast<size_t>(plane)) *
               SuperpixelBorder::kNumPixels;
  }

  const std::vector<SuperpixelBorder>& borders_;
  DepthResolution resolution_;
  float full_gap_;
  int num_planes_;
  // Depths of each plane at the pixels of each border.
  std::vector<float> depths_;
};

}  // namespace tsar
