// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/observed_view.h"

#include <cstdint>
#include <vector>

namespace tsar {

// The numbers of source views that see a surface at the depth of a pixel, in
// front of it on the reference's ray, which would occlude it, and behind it on
// their own rays, which it would occlude. Also, how well its color fits.
struct OcclusionVotes {
  static constexpr uint8_t kNoColor = 255;

  uint8_t agreeing = 0;
  uint8_t in_front = 0;
  uint8_t behind = 0;
  // The two smallest color differences to the source views in which the point
  // is not occluded, from 0 to 254 at 20 gray levels over the three channels;
  // kNoColor where fewer views see it.
  uint8_t color = kNoColor;
  uint8_t second_color = kNoColor;

  TSAR_HD int Count() const { return agreeing + in_front + behind; }
};

// The surfaces that the views around the reference see. Holds references.
struct ViewSurfaces {
  // The reference, then its sources, on their rasters.
  const std::vector<ObservedView>& views;
  // For each source, the plane of each of its superpixels in its camera's
  // frame, invalid if there is none: the source's surface where it has no
  // confident depth.
  const std::vector<std::vector<Plane>>& planes_of_sources;
};

// The votes of all sources on the depths of some maps of the reference, which
// have one size and these intrinsics; no votes where a depth is 0.
std::vector<DeviceImage<OcclusionVotes>> CountOcclusionVotes(
    const ViewSurfaces& surfaces,
    const Intrinsics& intrinsics,
    const std::vector<ImageView<const float>>& depths,
    Device& device);

}  // namespace tsar
