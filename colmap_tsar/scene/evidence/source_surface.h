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

// Depths of one ray that differ by more than this share are of two surfaces.
inline constexpr float kOtherSurface = 0.04f;

// The depth of a view's superpixels on their planes, on its raster; 0 where a
// plane is invalid. planes: of each superpixel, in the view's camera frame.
DeviceImage<float> DepthOfPlanes(const ObservedView& view,
                                 const std::vector<Plane>& planes,
                                 Device& device);

// The same, but what the view measured where that is as good as certain.
DeviceImage<float> SeenDepth(const ObservedView& view,
                             const std::vector<Plane>& planes,
                             Device& device);

// The surface that a source sees, drawn into the reference: of each pixel of
// its raster the nearest depth around; infinite where the source shows none.
// depth: on the source's raster; 0 where there is none.
DeviceImage<float> DrawIntoReference(const ObservedView& reference,
                                     const ObservedView& source,
                                     ImageView<const float> depth,
                                     Device& device);

}  // namespace tsar
