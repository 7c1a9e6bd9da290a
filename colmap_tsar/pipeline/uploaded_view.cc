// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/uploaded_view.h"

#include "colmap_tsar/pipeline/gray.h"

#include <algorithm>

namespace tsar {

bool HasDepth(const Image<float>& depth) {
  return std::any_of(
      depth.begin(), depth.end(), [](float z) { return z > 0.f; });
}

std::shared_ptr<const UploadedView> UploadView(const ViewData& view,
                                               Device& device) {
  const DeviceImage<Rgb> color(device, view.color);
  auto uploaded = std::make_shared<UploadedView>();
  uploaded->camera = view.camera;
  uploaded->has_depth = HasDepth(view.depth);
  uploaded->gray = ComputeGray(color.View(), device);
  uploaded->depth = DeviceImage<float>(device, view.depth);
  return uploaded;
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
