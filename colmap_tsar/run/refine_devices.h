// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/main_memory.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/device_view_cache.h"
#include "colmap_tsar/run/gpu_workers.h"
#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/scene/model_scene.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// A device of a run, which works on one image at a time.
struct RefineWorker {
  std::string name;  // "GPU 1 (NVIDIA H200)", or "the CPU".
  std::unique_ptr<Device> device;
  // Shared by the workers of one memory.
  DeviceViewCache* views = nullptr;
};

// What a run works with.
struct RefineDevices {
  std::string description;  // "2 CPU threads", or the GPUs' names.
  std::vector<RefineWorker> workers;
  // After the workers, so that the views go before the devices that own their
  // memory.
  std::vector<std::unique_ptr<DeviceViewCache>> view_caches;
  PipelineSizes sizes;
  // See ComposeTask: the workers are GPUs.
  bool finds_scenes_ahead = false;
  // For the planes of the scene.
  ModelResources model;
  // Main memory for views, and for all rasters.
  size_t cache_num_bytes = 0;
  size_t raster_num_bytes = 0;
};

// Images are spread over the GPUs before one GPU gets a second image at a time,
// and on CPUs over the threads before the loops of an image are: images need
// not wait for each other. There are no more workers than num_images, which is
// at least 1.
//
// With device "auto", a GPU that was not named and cannot be used is left out
// with a warning, and the CPU takes the place of the last one; with "cuda", one
// must be left. Where a GPU's second worker cannot be made, a warning says so.
// Another says where one image alone needs more than cache_size, or than four
// fifths of machine_bytes, which count where they are less. Throws kDevice (a
// GPU that was named does not exist or cannot be used; none is left; its memory
// is too small for the images), kOutOfMemory (one image alone needs more than
// machine_bytes; no memory is left on a GPU that was named or on the last one,
// or main memory for its copies) and kBadOption (gpu_index).
RefineDevices CreateRefineDevices(const DeviceOptions& options,
                                  const WorkspaceOverview& overview,
                                  const MemoryPlanner& planner,
                                  int num_images,
                                  const GpuSystem& gpus = GpuSystem::Cuda(),
                                  int64_t machine_bytes = MainMemoryBytes());

// The threads of the pass that finds the planes of the scene, as many as memory
// allows, and what they may keep of it; no GPUs.
ModelResources PlanModelPass(const DeviceOptions& options,
                             const MemoryPlan& plan,
                             int64_t machine_bytes = MainMemoryBytes());

// Has that pass use these GPUs, which must outlive it, and what the plan has
// for them, as far as they have it.
void AddGpus(const std::vector<GpuWorkers>& gpus,
             const MemoryPlan& plan,
             ModelResources* resources);

// The most that each GPU held so far; nothing for the CPU.
std::vector<RunSummary::GpuMemory> PeakGpuMemory(const RefineDevices& devices);

}  // namespace tsar
