// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/gray_texture.h"
#include "colmap_tsar/priors/depth_prior.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tsar {

// One image of the workspace as input of the stages; all rasters have the size
// of its depth map.
struct ViewData {
  Camera camera;
  Image<Rgb> color;
  // The hypotheses.
  Image<float> depth;
  Image<Vec3f> normal;
  // The smallest matching costs of the hypotheses as COLMAP exported them, or
  // empty.
  Image<float> min_cost;
  int64_t num_depths = 0;      // Pixels with a hypothesis.
  int64_t num_not_finite = 0;  // NaN or infinite values that were dropped.
  // The depth prior; null if there is none.
  std::shared_ptr<const DepthPrior> prior;
};

// The data of a source view that the stages need, in a device's memory.
struct UploadedView {
  Camera camera;
  bool has_depth = false;  // Whether any pixel has a depth.
  GrayTexture gray;
  DeviceImage<float> depth;  // Empty where the view has no depth map.
};

// Whether any pixel has a depth.
bool HasDepth(const Image<float>& depth);

// Uploads a view; the device may still be working on return. spare: an unused
// view, whose memory is reused if it has the same size.
std::shared_ptr<const UploadedView> UploadView(
    const ViewData& view,
    Device& device,
    std::shared_ptr<UploadedView> spare = nullptr);
std::vector<std::shared_ptr<const UploadedView>> UploadViews(
    const std::vector<const ViewData*>& views, Device& device);

}  // namespace tsar
