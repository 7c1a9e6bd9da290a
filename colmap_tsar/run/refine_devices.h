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

// The devices of a run and the division of its memory.
struct RefineDevices {
  std::string description;  // "2 CPU threads", or the GPUs' names.
  std::vector<RefineWorker> workers;
  // Declared after the workers, so that the views are freed before the devices
  // that own their memory.
  std::vector<std::unique_ptr<DeviceViewCache>> view_caches;
  PipelineSizes sizes;
  // Whether the workers are GPUs, see ComposePass.
  bool finds_scenes_ahead = false;
  // The resources of the pass that finds the planes of the scene.
  ModelResources model;
  size_t cache_num_bytes = 0;  // Main memory for views.

  // The number of images with workers, and of those whose scenes are found
  // ahead.
  size_t NumScenes() const {
    return workers.size() +
           (finds_scenes_ahead ? static_cast<size_t>(sizes.num_loaders) : 0);
  }
};

// Each GPU gets one image before one gets a second at a time, and CPU threads
// work on different images before they share one, since images need not wait
// for each other. There are at most num_images workers; num_images is at least
// 1.
//
// With device "auto", an unnamed GPU that cannot be used is left out with a
// warning, and the CPU takes the place of the last one; with "cuda", one must
// be left. A warning tells where a GPU's second worker cannot be made, and
// where one image alone needs more than the smaller of cache_size and four
// fifths of machine_bytes. Throws kDevice (a named GPU does not exist or cannot
// be used; none is left; its memory is too small for the images), kOutOfMemory
// (one image alone needs more than machine_bytes; no memory is left on a named
// GPU or on the last one, or main memory for its copies) and kBadOption
// (gpu_index).
RefineDevices CreateRefineDevices(const DeviceOptions& options,
                                  const WorkspaceOverview& overview,
                                  const MemoryPlanner& planner,
                                  int num_images,
                                  const GpuSystem& gpus = GpuSystem::Cuda(),
                                  int64_t machine_bytes = MainMemoryBytes());

// The threads of the pass that finds the planes of the scene, as many as memory
// allows, and the evidence that they may keep; no GPUs.
ModelResources PlanModelPass(const DeviceOptions& options,
                             const MemoryPlan& plan,
                             int64_t machine_bytes = MainMemoryBytes());

// Lets that pass use these GPUs, which must outlive it, and as much of their
// memory as the plan allows and they have.
void AddGpus(const std::vector<GpuWorkers>& gpus,
             const MemoryPlan& plan,
             ModelResources* resources);

// The peak memory of each GPU; nothing for the CPU.
std::vector<RunSummary::GpuMemory> PeakGpuMemory(const RefineDevices& devices);

}  // namespace tsar
