// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene_planes/view_evidence.h"

#include <vector>

namespace tsar {

// What a border between two superpixels costs for each pair of labels, of which
// the last one is 'none'. Keeps references to the evidence and the
// planes.
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
  const std::vector<SuperpixelBorder>& borders_;
  DepthResolution resolution_;
  const std::vector<Plane>& planes_;
  float full_gap_;
  // Of the pixels of each border. Depths along them are computed when they are
  // asked for: most planes are too dear for both superpixels.
  std::vector<Vec3f> rays_;
};

}  // namespace tsar
