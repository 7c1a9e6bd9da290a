// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/observed_source.h"

#include <cstdint>
#include <vector>

namespace tsar {

// How many source views see a surface at the depth of a pixel, one in front of
// it on the reference's own ray, which would hide it, and one behind it on
// theirs, which it would hide.
struct ViewVotes {
  uint8_t agreeing = 0;
  uint8_t in_front = 0;
  uint8_t behind = 0;

  TSAR_HD int Count() const { return agreeing + in_front + behind; }
};

// What the views around the reference see. Keeps references.
struct ViewSurfaces {
  // The reference, then its sources, on their rasters.
  const std::vector<ObservedView>& views;
  // For each source the plane of each of its superpixels, in its camera's
  // frame, invalid where there is none: where the source measured nothing that
  // is as good as certain, its surface is that plane.
  const std::vector<std::vector<Plane>>& planes_of_sources;
};

// The surfaces of all sources, drawn once for all that is asked of them.
class ViewVoter {
 public:
  ViewVoter(const ViewSurfaces& surfaces, Device& device);

  // The votes of all sources on the depths of a map of the reference with these
  // intrinsics; none where a depth is 0.
  DeviceImage<ViewVotes> Count(ImageView<const float> depth,
                               const Intrinsics& intrinsics) const;

 private:
  struct Source {
    ObservedSource view;
    DeviceImage<float> seen;   // On its raster: see SeenDepth().
    DeviceImage<float> front;  // In the reference: see DrawIntoReference().
  };

  Device& device_;
  std::vector<Source> sources_;
};

}  // namespace tsar
