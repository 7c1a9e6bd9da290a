// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/pipeline_devices.h"

#include "colmap_tsar/base/start_thread.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

// Reading an image takes up to ten times as long as the GPU needs for it, and
// writing it four fifths of that.
constexpr int kThreadsPerGpu = 38;
// A CPU takes so long for an image that one thread reads and writes for many
// that compute.
constexpr int kCpuWorkersPerThread = 8;

void AddGpuWorkers(std::vector<GpuWorkers> opened,
                   int num_sources,
                   PipelineDevices* result) {
  for (GpuWorkers& gpu : opened) {
    result->description += (result->description.empty() ? "" : ", ") + gpu.name;
    result->view_caches.push_back(std::make_unique<UploadedViews>(
        static_cast<size_t>(num_sources) + gpu.devices.size()));
    for (std::unique_ptr<Device>& device : gpu.devices) {
      result->workers.push_back(
          {gpu.name, std::move(device), result->view_caches.back().get()});
    }
  }
}

void AddCpuWorkers(int num_workers,
                   int num_sources,
                   int num_threads,
                   PipelineDevices* result) {
  result->description = std::to_string(num_threads) + " CPU thread" +
                        (num_threads == 1 ? "" : "s");
  result->view_caches.push_back(std::make_unique<UploadedViews>(
      static_cast<size_t>(num_sources + num_workers)));
  for (int i = 0; i < num_workers; ++i) {
    const int remainder = i < num_threads % num_workers ? 1 : 0;
    result->workers.push_back(
        {"the CPU",
         Device::CreateCpu(num_threads / num_workers + remainder),
         result->view_caches.back().get()});
  }
}

// The threads of the pass that finds the planes of the scene, as many as memory
// allows, the evidence that they may keep, and the GPUs, which must outlive it.
ModelResources PlanModelPass(const DeviceOptions& options,
                             const MemoryPlan& plan,
                             const std::vector<GpuWorkers>& gpus,
                             int64_t machine_bytes) {
  const int64_t budget = MainMemoryBudget(options.cache_size, machine_bytes);
  ModelResources resources;
  resources.num_threads = NumThreads(options.num_threads);
  resources.num_blocks =
      NumThatFit(budget, plan.model_block, resources.num_threads);
  resources.num_views =
      NumThatFit(budget, plan.label_view, resources.num_threads);
  resources.max_kept_bytes =
      std::max<int64_t>(budget - resources.num_views * plan.label_view, 0);
  for (const GpuWorkers& gpu : gpus) {
    for (const std::unique_ptr<Device>& device : gpu.devices) {
      resources.gpus.push_back({gpu.name, device.get()});
    }
  }
  return resources;
}

}  // namespace

UploadedViews::Pointer PipelineWorker::Upload(int image,
                                              const ViewData& view) const {
  return views->Get(image, [&](UploadedViews::Pointer spare) {
    auto uploaded = UploadView(
        view, *device, std::const_pointer_cast<UploadedView>(std::move(spare)));
    device->Synchronize();
    return uploaded;
  });
}

std::vector<UploadedViews::Pointer> PipelineWorker::UploadSources(
    const std::vector<int>& sources,
    int reference,
    LoadedViews* loaded,
    int first_key) const {
  std::vector<UploadedViews::Pointer> uploaded;
  for (const int source : sources) {
    uploaded.push_back(Upload(first_key + source, loaded->Get(source)));
    if (source != reference) {
      loaded->Release(source);
    }
  }
  return uploaded;
}

PipelineDevices OpenPipelineDevices(const DeviceOptions& options,
                                    const MemoryPlan& plan,
                                    int num_images,
                                    const GpuSystem& gpus,
                                    int64_t machine_bytes) {
  const int num_threads = NumThreads(options.num_threads);
  PipelineDevices result;
  std::vector<GpuWorkers> opened =
      OpenGpus(options, plan.device, num_images, gpus);
  const bool on_cpu = opened.empty();
  ImagesAtWork wanted;
  if (on_cpu) {
    wanted.num_workers = std::min(num_threads, num_images);
    wanted.num_threads =
        wanted.num_workers +
        (wanted.num_workers + kCpuWorkersPerThread - 1) / kCpuWorkersPerThread;
  } else {
    wanted.num_workers = 0;
    for (const GpuWorkers& gpu : opened) {
      wanted.num_workers += static_cast<int>(gpu.devices.size());
    }
    // More threads than cores: most of the time they wait for each other, for
    // the GPU or for the disk, at different places in each pass.
    wanted.num_threads =
        wanted.num_workers +
        std::min(num_threads * 5 / 4,
                 kThreadsPerGpu * static_cast<int>(opened.size()));
  }
  wanted.num_threads = std::min(wanted.num_threads, num_images);
  result.at_work = FitIntoMainMemory(
      plan, wanted, on_cpu, options.cache_size, machine_bytes);
  result.model = PlanModelPass(options, plan, opened, machine_bytes);
  if (on_cpu) {
    AddCpuWorkers(
        result.at_work.num_workers, plan.num_sources, num_threads, &result);
  } else {
    AddGpuWorkers(std::move(opened), plan.num_sources, &result);
    result.finds_scenes_ahead = true;
  }
  return result;
}

std::vector<RunSummary::GpuMemory> PeakGpuMemory(
    const PipelineDevices& devices) {
  std::vector<RunSummary::GpuMemory> peaks;
  for (const PipelineWorker& worker : devices.workers) {
    const size_t num_bytes = worker.device->PeakMemory();
    if (num_bytes > 0 && (peaks.empty() || peaks.back().gpu != worker.name)) {
      peaks.push_back({worker.name, num_bytes});
    }
  }
  return peaks;
}

}  // namespace tsar
