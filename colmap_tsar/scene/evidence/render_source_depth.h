// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/observed_view.h"

#include <vector>

namespace tsar {

// Depths along one ray that differ by more than this share are of two surfaces.
inline constexpr float kOtherSurface = 0.04f;

// The depth map of the planes of a view's superpixels, on its raster; 0 where a
// plane is invalid. planes: of each superpixel, in the view's camera frame.
DeviceImage<float> DepthOfPlanes(const ObservedView& view,
                                 const std::vector<Plane>& planes,
                                 Device& device);

// The depth map of DepthOfPlanes, replaced by measured depths where they are
// almost certain.
DeviceImage<float> SeenDepth(const ObservedView& view,
                             const std::vector<Plane>& planes,
                             Device& device);

// Renders the depth map of a source into the reference: for each pixel of its
// raster the nearest depth around; infinite where the source shows none. depth:
// on the source's raster; 0 where there is none.
DeviceImage<float> RenderSourceDepth(const ObservedView& reference,
                                     const ObservedView& source,
                                     ImageView<const float> depth,
                                     Device& device);

}  // namespace tsar
