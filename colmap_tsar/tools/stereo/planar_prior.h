// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// The planar prior (Xu and Tao, "Planar Prior Assisted PatchMatch Multi-View
// Stereo", AAAI 2020): between reliable depths, a textureless surface is
// probably planar.

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

#include <cstdint>

namespace tsar {

// For each pixel, the plane of its triangle in the Delaunay triangulation of at
// most one depth for each small square of the image: the median of the square's
// depths, if it has enough. Invalid outside of all triangles. depth: z in the
// camera frame, 0 if unreliable.
Image<Plane> TriangulatePlanes(const Image<float>& depth,
                               const Intrinsics& intrinsics);

// The reference's depths that match well and that the depths of two sources (or
// the only one) confirm; the others become 0.
DeviceImage<float> FindReliableDepth(const ReferenceView& reference,
                                     const Buffer<SourceView>& sources,
                                     float window_radius,
                                     Device& device);

}  // namespace tsar
