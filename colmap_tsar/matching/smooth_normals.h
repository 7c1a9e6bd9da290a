// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"

namespace tsar {

struct SmoothNormalsOptions {
  int radius = 2;  // Of the window, in pixels.
  // Neighbors whose depth lies farther from the pixel's plane, as a fraction
  // of depth, or whose normal is more than acos(min_cos_angle) off, belong to
  // another surface.
  float max_depth_error = 0.01f;
  float min_cos_angle = 0.7f;
};

// Each normal averaged with those of the same surface around it: stereo_fusion
// drops views whose normals are more than 10 degrees apart, and windows of
// little texture leave more noise than that. Pixels with depth 0 keep theirs.
DeviceImage<Vec3f> SmoothNormals(const Intrinsics& intrinsics,
                                 ImageView<const float> depth,
                                 ImageView<const Vec3f> normal,
                                 const SmoothNormalsOptions& options,
                                 Device& device);

}  // namespace tsar
