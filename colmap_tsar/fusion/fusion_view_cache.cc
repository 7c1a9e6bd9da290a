// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_view_cache.h"

#include <cstddef>
#include <optional>
#include <utility>

namespace tsar {
namespace {

template <typename AnyImage>
int64_t BytesOf(const AnyImage& image) {
  return int64_t{image.Width()} * image.Height() *
         static_cast<int64_t>(sizeof(FusionPixel));
}

}  // namespace

void FusionViewCache::Hold(const std::vector<int>& images,
                           const LoadAll& load_all) {
  std::vector<int> missing;
  int64_t num_new_bytes = 0;
  for (const int image : images) {
    if (views_.Use(image) == nullptr) {
      missing.push_back(image);
      num_new_bytes +=
          num_pixels_(image) * static_cast<int64_t>(sizeof(FusionPixel));
    }
  }
  // Those that are used now are the newest.
  const size_t num_used = images.size() - missing.size();
  while (views_.Size() > num_used && num_bytes_ + num_new_bytes > max_bytes_) {
    const std::optional<FusionView> oldest =
        views_.TakeOldest([](const FusionView&) { return true; });
    num_bytes_ -= BytesOf(oldest->pixels);
  }
  std::vector<FusionView> loaded(missing.size());
  load_all(missing, [&](size_t i) { loaded[i] = load_(missing[i]); });
  for (size_t i = 0; i < missing.size(); ++i) {
    num_bytes_ += BytesOf(loaded[i].pixels);
    views_.Add(missing[i], std::move(loaded[i]));
  }
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
      const int64_t num_bytes = BytesOf(view.pixels);
      while (copies_.Size() > num_used && num_bytes_ + num_bytes > max_bytes_) {
        const auto oldest = copies_.TakeOldest(
            [](const DeviceImage<FusionPixel>&) { return true; });
        num_bytes_ -= BytesOf(*oldest);
      }
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
