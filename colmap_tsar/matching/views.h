// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/matching/gray_pair.h"

namespace tsar {

// What matching knows of the image whose depth map is refined. All rasters have
// the size of the depth map and lie in the device's memory.
struct ReferenceView {
  Intrinsics intrinsics;
  ImageView<const float> gray;    // 0-255
  ImageView<const float> depth;   // z in the camera frame, 0 = invalid
  ImageView<const Vec3f> normal;  // unit, camera frame, towards the camera
};

// What matching knows of an image that shows the same surfaces. Gray and depth
// share one size, which may differ from the reference's.
struct SourceView {
  Intrinsics intrinsics;
  RelativePose from_reference;
  ImageView<const GrayPair> gray;
  ImageView<const float> depth;  // z in the source's frame; may be empty
};

}  // namespace tsar
