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

// What the stages need of a source image, in a device's memory.
struct UploadedView {
  Camera camera;
  bool has_depth = false;  // In any pixel.
  DeviceImage<GrayPair> gray;
  DeviceImage<float> depth;
};

// Whether any pixel has a depth.
bool HasDepth(const Image<float>& depth);

// The work may still be under way on the device. spare: a view that nobody uses
// any more; one of the same size gives its memory.
std::shared_ptr<const UploadedView> UploadView(
    const ViewData& view,
    Device& device,
    std::shared_ptr<UploadedView> spare = nullptr);
std::vector<std::shared_ptr<const UploadedView>> UploadViews(
    const std::vector<const ViewData*>& views, Device& device);

int64_t UploadedViewBytes(int64_t num_pixels);

}  // namespace tsar
