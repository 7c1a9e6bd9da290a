// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/fusion/fuse_view.h"
#include "colmap_tsar/fusion/fusion_pixel.h"
#include "colmap_tsar/run/shared_cache.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <map>
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

// Views by their images' indices in the sparse model.
using FusionViews = std::map<int, SharedCache<FusionView>::Pointer>;

// A device's access to views: a GPU gets copies, max_num_views of which stay
// there; the CPU reads those in main memory.
class FusionDevice {
 public:
  FusionDevice(Device& device, size_t max_num_views)
      : device_(device), copies_(max_num_views) {}

  Device& GetDevice() { return device_; }

  // The images in order; valid until the next call, and as long as the views.
  std::vector<FusionInput> Use(const std::vector<int>& images,
                               const FusionViews& views);

 private:
  using Copies = SharedCache<DeviceImage<FusionPixel>>;

  Device& device_;
  Copies copies_;
  std::vector<Copies::Pointer> in_use_;
};

}  // namespace tsar
