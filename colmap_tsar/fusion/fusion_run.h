// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/fusion/fuse_view.h"
#include "colmap_tsar/fusion/fusion_neighbors.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/gpu_workers.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/shared_cache.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
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
  int image = 0;  // Index in the sparse model.
  // At the size of the maps; valid until the call ends.
  const FusionView* view = nullptr;
  std::vector<FusedPoint> points;  // Their sources are those of the plan.
};

// Views by their images' indices in the sparse model.
using FusionViews = std::map<int, std::shared_ptr<const FusionView>>;

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

// Fuses the images of a plan, as many concurrently as there are devices. Main
// memory holds the images at work, up to cache_size, but at least one image
// with its sources and the next one with its own; what the next ones need as
// well stays there.
class FusionRun {
 public:
  // All references must outlive this object. Throws what OpenGpus and
  // ReadMapSize throw.
  FusionRun(const Workspace& workspace,
            const FusionPlan& plan,
            const FusionOptions& fusion,
            const DeviceOptions& devices);
  FusionRun(const FusionRun&) = delete;
  FusionRun& operator=(const FusionRun&) = delete;

  // Called from several threads with the points of an image. place: its index
  // in the plan's order.
  using UsePoints = std::function<void(size_t place, FusedImage fused)>;
  // Called from one thread in the plan's order, after UsePoints for that place.
  using Finish = std::function<void(size_t place)>;

  // Throws Error kInterrupted where the user asked to stop, and what the
  // readers of maps and photos and the functions throw.
  void Run(const UsePoints& use, const Finish& finish, Progress& progress);

  // "2 CPU threads", or the GPUs' names.
  const std::string& Description() const { return description_; }
  std::vector<RunSummary::GpuMemory> PeakGpuMemory() const;

 private:
  const std::vector<int>& SourcesOf(int image) const {
    return plan_.sources[image];
  }
  // The image and its sources.
  std::vector<int> ImagesOf(int image) const;
  // The size of the points of an image, with their encoded form, if every
  // candidate pixel becomes a point that all sources see.
  int64_t ResultBytes(int image) const;

  // Reads the map sizes of all images that are used.
  void MeasureImages();
  void OpenDevices();

  // Consecutive images of the plan that are processed together: as many as fit
  // into half of the memory with their sources, but no more than needed to keep
  // all threads busy. While GPUs fuse them, the views of the next group are
  // read.
  struct Group {
    size_t begin = 0;
    size_t end = 0;
    std::vector<int> needed;  // Images that are to be in memory.
  };
  Group GroupFrom(size_t begin) const;
  // The needed views. loaded: those of the group before, which are shared.
  FusionViews Load(const Group& group,
                   const FusionViews& loaded,
                   Progress& progress) const;
  void FuseGroup(const Group& group,
                 const FusionViews& views,
                 const UsePoints& use,
                 Progress& progress);
  FusedImage Fuse(int image,
                  const FusionViews& views,
                  FusionDevice* device) const;

  const Workspace& workspace_;
  const FusionPlan& plan_;
  const FusionOptions& fusion_;
  const DeviceOptions& device_options_;
  std::vector<int64_t> num_pixels_;  // By image; 0 where it is not used.
  int max_width_ = 0;
  int max_height_ = 0;
  const int64_t max_group_bytes_;
  std::string description_;
  std::vector<GpuWorkers> gpus_;
  std::unique_ptr<Device> cpu_;
  // Declared after the devices, whose memory they hold.
  std::deque<FusionDevice> devices_;
};

}  // namespace tsar
