// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/gray_texture.h"

#include <utility>
#include <vector>

namespace tsar {

// The reference view of matching. All rasters have the size of its depth map
// and are in the device's memory.
struct ReferenceView {
  Intrinsics intrinsics;
  GrayView gray;
  ImageView<const float> depth;   // z in the camera frame, 0 = invalid
  ImageView<const Vec3f> normal;  // unit, camera frame, towards the camera
};

// A source view of matching. Gray and depth share one size, which may differ
// from the reference's.
struct SourceView {
  Intrinsics intrinsics;
  RelativePose from_reference;
  GrayView gray;
  ImageView<const float> depth;  // z in the source's frame; may be empty
};

// The sources of a reference: in the device's memory, and a copy in the host's.
class SourceViews {
 public:
  SourceViews() = default;
  SourceViews(Device& device, std::vector<SourceView> views)
      : on_device_(device, views), host_(std::move(views)) {}

  int Size() const { return static_cast<int>(host_.size()); }
  const SourceView* Data() const { return on_device_.Data(); }
  const std::vector<SourceView>& Host() const { return host_; }

 private:
  Buffer<SourceView> on_device_;
  std::vector<SourceView> host_;
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
