// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_view.h"

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/run/store/image_maps.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>

namespace tsar {
namespace {

// The standard deviation of a matched depth, in pixels of disparity.
constexpr float kPixelsOfDisparity = 0.25f;

}  // namespace

FusionView LoadFusionView(const Workspace& workspace,
                          int image,
                          const std::vector<int>& sources) {
  const ImageMaps maps = ReadImageMaps(workspace, image);
  const int width = maps.depth.Width();
  const int height = maps.depth.Height();
  const Image<Rgb> color = workspace.ReadImage(image, width, height);
  const auto camera_of = [&](int i) -> const Camera& {
    return workspace.Model().images[i].camera;
  };
  FusionView view{camera_of(image).Resized(width, height), {width, height}};
  std::vector<Camera> cameras;
  for (const int source : sources) {
    cameras.push_back(camera_of(source));
  }
  const DepthResolution resolution =
      ComputeDisparityScale(view.camera, cameras);
  for (size_t i = 0; i < maps.depth.NumPixels(); ++i) {
    const float depth = maps.depth.Data()[i];
    if (!(depth > 0.f)) {
      continue;
    }
    FusionPixel& pixel = view.pixels.Data()[i];
    pixel.depth = depth;
    EncodeNormal(maps.normal.Data()[i], &pixel);
    pixel.color = color.Data()[i];
    pixel.confidence = maps.confidence.Empty()
                           ? std::numeric_limits<uint8_t>::max()
                           : std::max(maps.confidence.Data()[i], uint8_t{1});
    const float sigma = maps.sigma.Empty() ? 0.f : maps.sigma.Data()[i];
    pixel.sigma =
        EncodeSigma(sigma > 0.f ? sigma / depth
                                : kPixelsOfDisparity *
                                      resolution.RelativeDepthError(depth));
  }
  return view;
}

std::vector<FusionInput> FusionDevice::Use(const std::vector<int>& images,
                                           const FusionViews& views) {
  std::vector<FusionInput> inputs;
  if (!device_.IsCuda()) {
    for (const int image : images) {
      const FusionView& view = *views.at(image);
      inputs.push_back({view.camera, view.pixels.View()});
    }
    return inputs;
  }
  in_use_.clear();
  in_use_ = copies_.GetAll(
      images,
      [&](int image) {
        return std::make_shared<const DeviceImage<FusionPixel>>(
            device_, views.at(image)->pixels);
      },
      [] { return false; });
  for (size_t i = 0; i < images.size(); ++i) {
    inputs.push_back({views.at(images[i])->camera, in_use_[i]->View()});
  }
  return inputs;
}

}  // namespace tsar
