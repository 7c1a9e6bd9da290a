// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/view_data.h"

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/gray_pair.h"

#include <algorithm>

namespace tsar {

<<<<<<< HEAD
size_t ViewData::NumBytes() const {
  return color.NumPixels() * sizeof(Rgb) + depth.NumPixels() * sizeof(float) +
         normal.NumPixels() * sizeof(Vec3f) +
         is_to_refine.NumPixels() * sizeof(uint8_t) +
         (min_cost.NumPixels() + second_cost.NumPixels()) * sizeof(float) +
         (prior ? prior->NumBytes() : 0);
}

int64_t ViewDataBytes(int64_t num_pixels, bool has_costs) {
  const size_t bytes_per_pixel = sizeof(Rgb) + sizeof(float) + sizeof(Vec3f) +
                                 sizeof(uint8_t) +
                                 (has_costs ? 2 * sizeof(float) : 0);
  return num_pixels * static_cast<int64_t>(bytes_per_pixel);
}

=======
>>>>>>> b7dc91b1 (What predicted bytes of views, maps and priors goes with its last caller)
bool HasDepth(const Image<float>& depth) {
  return std::any_of(
      depth.begin(), depth.end(), [](float z) { return z > 0.f; });
}

std::shared_ptr<const UploadedView> UploadView(
    const ViewData& view, Device& device, std::shared_ptr<UploadedView> spare) {
  const int width = view.depth.Width();
  const int height = view.depth.Height();
  if (spare == nullptr || spare->depth.Width() != width ||
      spare->depth.Height() != height) {
    spare = std::make_shared<UploadedView>();
    spare->gray = DeviceImage<GrayPair>(device, width, height);
    spare->depth = DeviceImage<float>(device, width, height);
  }
  spare->camera = view.camera;
  spare->has_depth = HasDepth(view.depth);
  const DeviceImage<Rgb> color(device, view.color);
  ComputeGrayPairs(color.View(), spare->gray.View(), device);
  // Upload() cannot be used, since another device may have allocated the
  // memory.
  device.CopyToDevice(spare->depth.View().data,
                      view.depth.Data(),
                      view.depth.NumPixels() * sizeof(float));
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
