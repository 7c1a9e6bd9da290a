// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

namespace tsar {

// Computes the normals of a depth map (z in the camera frame, 0 = none): unit
// vectors in the camera frame, towards the camera; (0, 0, 0) if undetermined.
//
// A plane's inverse depth is linear in the pixel's position, so its differences
// give the exact normal. Central differences are used along each axis; a
// one-sided difference if the other neighbor has no depth, differs by more than
// 5 % of the depth, or has more than twice the other difference beyond noise,
// as at creases and occlusion boundaries. A pixel without a neighbor along one
// of the axes has no normal.
Image<Vec3f> NormalsFromDepth(const Image<float>& depth,
                              const Intrinsics& intrinsics);

}  // namespace tsar
