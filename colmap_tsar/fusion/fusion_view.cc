// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_view.h"

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/run/store/image_maps.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

namespace tsar {
namespace {

// The standard deviation of a matched depth, in pixels of disparity.
constexpr float kPixelsOfDisparity = 0.25f;

int64_t BytesOf(const DeviceImage<FusionPixel>& copy) {
  return int64_t{copy.Width()} * copy.Height() *
         static_cast<int64_t>(sizeof(FusionPixel));
}

int64_t BytesOf(const FusionView& view) {
  return int64_t{view.pixels.Width()} * view.pixels.Height() *
         static_cast<int64_t>(sizeof(FusionPixel));
}

// Drops the least recently used values until the new bytes fit, or only the
// num_used latest are left, which are in use.
template <typename Value>
void MakeRoom(int64_t num_new_bytes,
              int64_t max_bytes,
              size_t num_used,
              LruMap<int, Value>* values,
              int64_t* num_bytes) {
  while (values->Size() > num_used && *num_bytes + num_new_bytes > max_bytes) {
    const std::optional<Value> oldest =
        values->TakeOldest([](const Value&) { return true; });
    *num_bytes -= BytesOf(*oldest);
  }
}

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

std::vector<int> FusionViewCache::Use(const std::vector<int>& images,
                                      const std::vector<int64_t>& num_pixels) {
  std::vector<int> missing;
  int64_t num_new_bytes = 0;
  for (const int image : images) {
    if (views_.Use(image) == nullptr) {
      missing.push_back(image);
      num_new_bytes +=
          num_pixels[image] * static_cast<int64_t>(sizeof(FusionPixel));
    }
  }
  // The images in use are the most recent ones.
  const size_t num_used = images.size() - missing.size();
  MakeRoom(num_new_bytes, max_bytes_, num_used, &views_, &num_bytes_);
  return missing;
}

void FusionViewCache::Add(int image, FusionView view) {
  num_bytes_ += BytesOf(view);
  views_.Add(image, std::move(view));
}

std::vector<FusionInput> FusionDevice::Use(const std::vector<int>& images,
                                           FusionViewCache& cache) {
  std::vector<FusionInput> inputs;
  if (!device_.IsCuda()) {
    for (const int image : images) {
      const FusionView& view = cache.Get(image);
      inputs.push_back({view.camera, view.pixels.View()});
    }
    return inputs;
  }
  size_t num_used = 0;
  for (const int image : images) {
    num_used += copies_.Use(image) != nullptr ? 1 : 0;
  }
  for (const int image : images) {
    const FusionView& view = cache.Get(image);
    if (copies_.Find(image) == nullptr) {
      const int64_t num_bytes = BytesOf(view);
      MakeRoom(num_bytes, max_bytes_, num_used, &copies_, &num_bytes_);
      copies_.Add(image, DeviceImage<FusionPixel>(device_, view.pixels));
      num_bytes_ += num_bytes;
      ++num_used;
    }
    const DeviceImage<FusionPixel>& copy = *copies_.Find(image);
    inputs.push_back({view.camera, copy.View()});
  }
  return inputs;
}

}  // namespace tsar
