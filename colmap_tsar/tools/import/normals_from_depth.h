// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

namespace tsar {

// The normals of a depth map (z in the camera frame, 0 = none): unit vectors in
// the camera frame, towards the camera, (0, 0, 0) where none can be told.
//
// A plane's inverse depth is linear in the pixel's position, so its differences
// give the normal without error. Along each axis both neighbors count, as a
// central difference; one alone where the other one has no depth, lies over 5 %
// of the depth away, or where the difference to it is more than twice the other
// one's and not just noise, as at a crease or at the edge of a thing in front
// of something. A pixel without a neighbor along one of the axes has no
// normal.
Image<Vec3f> NormalsFromDepth(const Image<float>& depth,
                              const Intrinsics& intrinsics);

}  // namespace tsar
