// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_view_cache.h"

#include <cstddef>
#include <optional>
#include <utility>

namespace tsar {
namespace {

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
  // The images in use are the most recent ones.
  const size_t num_used = images.size() - missing.size();
  MakeRoom(num_new_bytes, max_bytes_, num_used, &views_, &num_bytes_);
  std::vector<FusionView> loaded(missing.size());
  load_all(missing, [&](size_t i) { loaded[i] = load_(missing[i]); });
  for (size_t i = 0; i < missing.size(); ++i) {
    num_bytes_ += BytesOf(loaded[i]);
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
