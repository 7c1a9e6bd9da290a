// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/main_memory.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/gpu_workers.h"
#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/shared_cache.h"
#include "colmap_tsar/scene/model_scene.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// The source views in the memory of one GPU, or of the CPU, shared by all
// devices that use this memory: an image is uploaded once for the many images
// it is a source of.
//
// A caller must have waited for its device (Device::Synchronize) before it
// releases a view: the memory is freed in the stream order of the device that
// uploaded it, without regard to the work of other devices. That device must
// outlive the cache and all views.
using UploadedViews = SharedCache<UploadedView>;

// A device of a run, which works on one image at a time.
struct PipelineWorker {
  std::string name;  // "GPU 1 (NVIDIA H200)", or "the CPU".
  std::unique_ptr<Device> device;
  // Shared by the workers of one memory.
  UploadedViews* views = nullptr;

  // The view of the image in the device's memory, completely uploaded.
  UploadedViews::Pointer Upload(int image, const ViewData& view) const;
  // Uploads the sources of the reference, and releases their views but for the
  // reference's own. first_key: of image 0 in the cache, which tells apart
  // views of one image that differ.
  std::vector<UploadedViews::Pointer> UploadSources(
      const std::vector<int>& sources,
      int reference,
      LoadedViews* loaded,
      int first_key = 0) const;
};

// The devices of a run and the division of its memory.
struct PipelineDevices {
  std::string description;  // "2 CPU threads", or the GPUs' names.
  std::vector<PipelineWorker> workers;
  // Declared after the workers, so that the views are freed before the devices
  // that own their memory.
  std::vector<std::unique_ptr<UploadedViews>> view_caches;
  ImagesAtWork at_work;
  // Whether the workers are GPUs, see ComposePass.
  bool finds_scenes_ahead = false;
  // The resources of the pass that finds the planes of the scene.
  ModelResources model;

  // The number of images whose scenes are in memory at a time.
  int NumScenes() const {
    return finds_scenes_ahead ? at_work.num_threads : at_work.num_workers;
  }
};

// A GPU gets another image at a time only once every GPU has as many, and CPU
// threads share an image only once there is no other, since images need not
// wait for each other. There are at most num_images workers; num_images is at
// least 1.
//
// With device "auto", an unnamed GPU that cannot be used is left out with a
// warning, and the CPU is used if none is left; with "cuda", one must be left.
// Warns if a further worker of a GPU cannot be created, or one image alone
// needs more main memory than the budget. Throws kDevice (a named GPU does not
// exist or cannot be used; none is left; its memory is too small for the
// images), kOutOfMemory (one image alone needs more than machine_bytes; no
// memory is left on a named GPU or on the last one, or main memory for its
// copies) and kBadOption (gpu_index).
PipelineDevices OpenPipelineDevices(const DeviceOptions& options,
                                    const MemoryPlan& plan,
                                    int num_images,
                                    const GpuSystem& gpus = GpuSystem::Cuda(),
                                    int64_t machine_bytes = MainMemoryBytes());

// The peak memory of each GPU; nothing for the CPU.
std::vector<RunSummary::GpuMemory> PeakGpuMemory(
    const PipelineDevices& devices);

}  // namespace tsar
