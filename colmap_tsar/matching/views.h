// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/gray_pair.h"

namespace tsar {

// The reference view of matching. All rasters have the size of its depth map
// and are in the device's memory.
struct ReferenceView {
  Intrinsics intrinsics;
  ImageView<const float> gray;    // 0-255
  ImageView<const float> depth;   // z in the camera frame, 0 = invalid
  ImageView<const Vec3f> normal;  // unit, camera frame, towards the camera
};

// A source view of matching. Gray and depth share one size, which may differ
// from the reference's.
struct SourceView {
  Intrinsics intrinsics;
  RelativePose from_reference;
  ImageView<const GrayPair> gray;
  ImageView<const float> depth;  // z in the source's frame; may be empty
};

// A depth map with its normals: z = 0 and a zero normal where there is none.
struct DepthNormalViews {
  ImageView<const float> depth;
  ImageView<const Vec3f> normal;
};

struct DepthNormalImages {
  DeviceImage<float> depth;
  DeviceImage<Vec3f> normal;

  DepthNormalImages() = default;
  DepthNormalImages(Device& device, int width, int height)
      : depth(device, width, height), normal(device, width, height) {}
  DepthNormalViews Views() const { return {depth.View(), normal.View()}; }
};

}  // namespace tsar
