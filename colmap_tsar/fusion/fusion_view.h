// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/fusion/fuse_view.h"
#include "colmap_tsar/fusion/fusion_pixel.h"
#include "colmap_tsar/run/lru_map.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstdint>
#include <vector>

namespace tsar {

// An image with its maps, ready to be fused.
struct FusionView {
  Camera camera;  // At the size of the pixels, which is that of the maps.
  Image<FusionPixel> pixels;
};

// The maps of an image without masked pixels. sources: images of the same
// scene, by index in the sparse model; their baselines give the precision of
// depths without a sigma. Depths without a confidence map have full confidence.
// Errors as ReadImageMaps() and Workspace::ReadImage().
FusionView LoadFusionView(const Workspace& workspace,
                          int image,
                          const std::vector<int>& sources);

// Views in main memory, by their images' indices in the sparse model.
class FusionViewCache {
 public:
  explicit FusionViewCache(int64_t max_bytes) : max_bytes_(max_bytes) {}

  // Begins to use these images, which must be unique, instead of those of the
  // last call: returns the ones whose views are missing and to be added. Makes
  // room for them: drops the views of other images, the least recently used
  // first, as far as max_bytes requires. num_pixels: by image.
  std::vector<int> Use(const std::vector<int>& images,
                       const std::vector<int64_t>& num_pixels);

  void Add(int image, FusionView view);

  // An image in use whose view was added.
  const FusionView& Get(int image) { return *views_.Find(image); }

 private:
  const int64_t max_bytes_;
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
