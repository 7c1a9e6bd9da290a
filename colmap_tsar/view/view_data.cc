// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/view_data.h"

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/gray_texture.h"

#include <algorithm>

namespace tsar {

bool HasDepth(const Image<float>& depth) {
  return std::any_of(
      depth.begin(), depth.end(), [](float z) { return z > 0.f; });
}

std::shared_ptr<const UploadedView> UploadView(
    const ViewData& view, Device& device, std::shared_ptr<UploadedView> spare) {
  const int width = view.color.Width();
  const int height = view.color.Height();
  if (spare == nullptr || spare->gray.Width() != width ||
      spare->gray.Height() != height ||
      spare->depth.Width() != view.depth.Width() ||
      spare->depth.Height() != view.depth.Height()) {
    spare = std::make_shared<UploadedView>();
    spare->gray = GrayTexture(device, width, height);
    spare->depth =
        DeviceImage<float>(device, view.depth.Width(), view.depth.Height());
  }
  spare->camera = view.camera;
  spare->has_depth = HasDepth(view.depth);
  const DeviceImage<Rgb> color(device, view.color);
  ComputeGrayTexture(color.View(), &spare->gray, device);
  if (!view.depth.Empty()) {
    // Upload() cannot be used, since another device may have allocated the
    // memory.
    device.CopyToDevice(spare->depth.View().data,
                        view.depth.Data(),
                        view.depth.NumPixels() * sizeof(float));
  }
  return spare;
}

std::vector<std::shared_ptr<const UploadedView>> UploadViews(
    const std::vector<const ViewData*>& views, Device& device) {
  std::vector<std::shared_ptr<const UploadedView>> uploaded;
  for (const ViewData* view : views) {
    uploaded.push_back(UploadView(*view, device));
  }
  return uploaded;
}

}  // namespace tsar
