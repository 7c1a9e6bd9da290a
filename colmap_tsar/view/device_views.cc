// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/device_views.h"

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/matching/gray_texture.h"
#include "colmap_tsar/view/denoise/denoise.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"
#include "colmap_tsar/view/superpixels/samples.h"

#include <algorithm>
#include <cmath>

namespace tsar {

ReducedRaster MakeRaster(int width, int height) {
  const double scale = std::min(
      1.0, kMaxRasterSide / static_cast<double>(std::max(width, height)));
  return {std::max(1, static_cast<int>(std::lround(width * scale))),
          std::max(1, static_cast<int>(std::lround(height * scale)))};
}

DeviceReference::DeviceReference(const ViewData& view, Device& device)
    : camera(view.camera), color(device, view.color) {
  hypotheses.depth = DeviceImage<float>(device, view.depth);
  hypotheses.normal = DeviceImage<Vec3f>(device, view.normal);
}

DeviceViews::DeviceViews(
    const ViewData& reference,
    std::vector<std::shared_ptr<const UploadedView>> sources,
    Device& device,
    bool denoise)
    : DeviceReference(reference, device),
      device_(device),
      raster_(MakeRaster(reference.depth.Width(), reference.depth.Height())),
      raster_color_(MakeRasterColor(Color(), raster_, denoise, device)),
      gray_(ComputeGrayTexture(Color(), device)),
      uploaded_sources_(std::move(sources)) {
  std::vector<SourceView> views;
  std::vector<Camera> cameras;
  for (const auto& source : uploaded_sources_) {
    views.push_back({source->camera.GetIntrinsics(),
                     ComputeRelativePose(reference.camera, source->camera),
                     source->gray.View(),
                     source->depth.View()});
    cameras.push_back(source->camera);
    num_sources_with_depth_ += source->has_depth ? 1 : 0;
  }
  sources_ = SourceViews(device, std::move(views));
  scale_ = ComputeDisparityScale(reference.camera, cameras);
}

DeviceViews::~DeviceViews() {
  if (!uploaded_sources_.empty()) {
    const ScopedSynchronization synchronization(device_);
  }
}

void DeviceViews::ReleaseSources() {
  sources_ = {};
  uploaded_sources_.clear();
  gray_ = {};
}

Intrinsics DeviceViews::RasterIntrinsics() const {
  return camera.Resized(raster_.width, raster_.height).GetIntrinsics();
}

double DeviceViews::RasterScale() const {
  return std::max(raster_.width, raster_.height) /
         static_cast<double>(kMaxRasterSide);
}

int64_t MaxRasterPixels(int64_t num_pixels) {
  return std::min(num_pixels, int64_t{kMaxRasterSide} * kMaxRasterSide);
}

DeviceImage<Rgb> MakeRasterColor(ImageView<const Rgb> color,
                                 const ReducedRaster& raster,
                                 bool denoise,
                                 Device& device) {
  DeviceImage<Rgb> reduced = ReduceColor(color, raster, device);
  if (!denoise) {
    return reduced;
  }
  const ImageView<const Rgb> noisy = std::as_const(reduced).View();
  const DeviceImage<float> gray = ComputeGray(noisy, device);
  return Denoise(
      noisy, gray.View(), EstimateNoise(gray.View(), device), device);
}

}  // namespace tsar
