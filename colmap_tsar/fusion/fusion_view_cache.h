// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/fusion/fuse_view.h"
#include "colmap_tsar/fusion/fusion_view.h"
#include "colmap_tsar/run/lru_map.h"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace tsar {

// Images in main memory, by their indices in the sparse model.
class FusionViewCache {
 public:
  // Calls load(i) for each index i of `images`, in parallel.
  using LoadAll = std::function<void(const std::vector<int>& images,
                                     const std::function<void(size_t)>& load)>;
  using Load = std::function<FusionView(int image)>;
  using NumPixels = std::function<int64_t(int image)>;

  FusionViewCache(int64_t max_bytes, NumPixels num_pixels, Load load)
      : max_bytes_(max_bytes),
        num_pixels_(std::move(num_pixels)),
        load_(std::move(load)) {}

  // Holds these images, which must be unique, until the next call. Drops
  // others, the least recently used first, as far as max_bytes requires.
  void Hold(const std::vector<int>& images, const LoadAll& load_all);

  // An image that is held.
  const FusionView& Get(int image) { return *views_.Find(image); }

 private:
  const int64_t max_bytes_;
  const NumPixels num_pixels_;
  const Load load_;
  int64_t num_bytes_ = 0;
  LruMap<int, FusionView> views_;
};

// A device's access to the images of a cache: a GPU gets copies, which stay
// there while max_bytes allow; the CPU reads those of the cache.
class FusionDevice {
 public:
  FusionDevice(Device& device, int64_t max_bytes)
      : device_(device), max_bytes_(max_bytes) {}

  Device& GetDevice() { return device_; }

  // The images, which the cache holds, in order; valid until the next call.
  std::vector<FusionInput> Use(const std::vector<int>& images,
                               FusionViewCache& cache);

 private:
  Device& device_;
  const int64_t max_bytes_;
  int64_t num_bytes_ = 0;
  LruMap<int, DeviceImage<FusionPixel>> copies_;
};

}  // namespace tsar
