// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/gray_pair.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tsar {

// The data of a source view that the stages need, in a device's memory.
struct UploadedView {
  Camera camera;
  bool has_depth = false;  // Whether any pixel has a depth.
  DeviceImage<GrayPair> gray;
  DeviceImage<float> depth;
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

int64_t UploadedViewBytes(int64_t num_pixels);

}  // namespace tsar
