// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/fusion/fuse_view.h"
#include "colmap_tsar/fusion/fusion_neighbors.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// An image with its maps, ready to be fused.
struct FusionView {
  Camera camera;  // At the size of the pixels, which is that of the maps.
  Image<FusionPixel> pixels;
};

// The points of one image.
struct FusedImage {
  std::shared_ptr<const FusionView> view;
  std::vector<FusedPoint> points;  // Their sources are those of the plan.
};

struct FusionDevices {
  std::string description;  // "2 CPU threads", or the GPUs' names.
  std::vector<RunSummary::GpuMemory> peak_gpu_memory;
};

// Called from several threads with the points of each image. place: the index
// of the image in the plan's order.
using UsePoints = std::function<void(size_t place, const FusedImage& fused)>;

// Fuses the images of a plan.
//
// Main memory holds the images at work with their sources, as many as fit into
// cache_size, but at least one image; views that the next ones need stay there.
//
// Throws Error kInterrupted where the user asked to stop, and what
// OpenPipelineDevices, the readers of maps and photos and the function throw.
FusionDevices FuseImages(const Workspace& workspace,
                         const FusionPlan& plan,
                         const FusionOptions& fusion,
                         const DeviceOptions& devices,
                         const UsePoints& use,
                         Progress& progress);

}  // namespace tsar
