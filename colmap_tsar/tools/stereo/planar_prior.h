// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// The planar prior (Xu and Tao, "Planar Prior Assisted
// PatchMatch Multi-View Stereo", AAAI 2020): between depths that can be relied
// on, a surface without texture is probably flat.

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

#include <cstdint>

namespace tsar {

// For each pixel the plane of the triangle that it lies in, of the Delaunay
// triangulation of at most one depth for each small square of the image: the
// median of the square's depths, if it is dense with them. Invalid outside of
// all triangles.
// depth: z in the camera frame, 0 where none can be relied on.
Image<Plane> TriangulatePlanes(const Image<float>& depth,
                               const Intrinsics& intrinsics);

// The planes of the triangles between those depths of the reference that match
// well and that the depths of two sources confirm, or that of the only one.
Image<Plane> FindPlanarPrior(const ReferenceView& reference,
                             const Buffer<SourceView>& sources,
                             float window_radius,
                             Device& device);

}  // namespace tsar
