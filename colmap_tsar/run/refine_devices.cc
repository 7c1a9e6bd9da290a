// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_devices.h"

#include "colmap_tsar/run/main_memory_division.h"

#include <algorithm>
#include <limits>
#include <thread>
#include <utility>

namespace tsar {
namespace {

// Reading an image takes up to ten times as long as one GPU with its two
// workers needs for it, and half of the readers wait for a view that another
// one is reading.
constexpr int kLoadersPerGpu = 20;
// A CPU takes so long for an image that one loader supplies many workers.
constexpr int kCpuWorkersPerLoader = 8;

std::string Describe(const std::vector<GpuWorkers>& gpus) {
  std::string text;
  for (const GpuWorkers& gpu : gpus) {
    text += (text.empty() ? "" : ", ") + gpu.name;
  }
  return text;
}

void AddGpuWorkers(std::vector<GpuWorkers> opened,
                   const MemoryPlan& plan,
                   RefineDevices* result) {
  result->description = Describe(opened);
  for (GpuWorkers& gpu : opened) {
    const int num_workers = static_cast<int>(gpu.devices.size());
    result->view_caches.push_back(std::make_unique<DeviceViewCache>(
        static_cast<size_t>(SharedViewBytes(plan, num_workers))));
    for (std::unique_ptr<Device>& device : gpu.devices) {
      result->workers.push_back(
          {gpu.name, std::move(device), result->view_caches.back().get()});
    }
  }
}

void AddCpuWorkers(int num_workers,
                   const MemoryPlan& plan,
                   int num_threads,
                   RefineDevices* result) {
  result->description = std::to_string(num_threads) + " CPU thread" +
                        (num_threads == 1 ? "" : "s");
  result->view_caches.push_back(std::make_unique<DeviceViewCache>(
      static_cast<size_t>(SharedViewBytes(plan, num_workers))));
  for (int i = 0; i < num_workers; ++i) {
    const int remainder = i < num_threads % num_workers ? 1 : 0;
    result->workers.push_back(
        {"the CPU",
         Device::CreateCpu(num_threads / num_workers + remainder),
         result->view_caches.back().get()});
  }
}

int NumThreads(int wanted) {
  return wanted > 0
             ? wanted
             : std::max(1,
                        static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace

RefineDevices CreateRefineDevices(const DeviceOptions& options,
                                  const WorkspaceOverview& overview,
                                  const MemoryPlanner& planner,
                                  int num_images,
                                  const GpuSystem& gpus,
                                  int64_t machine_bytes) {
  const int num_threads = NumThreads(options.num_threads);
  const MemoryBudget budget(options.cache_size, machine_bytes);
  const MemoryPlan plan = planner(overview);
  RefineDevices result;
  std::vector<GpuWorkers> opened = OpenGpus(options, plan, num_images, gpus);
  result.model = PlanModelPass(options, plan, machine_bytes);
  AddGpus(opened, plan, &result.model);
  const MainMemoryDivision division(
      planner, overview, num_images, /*on_cpu=*/opened.empty());
  int max_num_loaders = 0;
  if (opened.empty()) {
    const int num_workers =
        division.NumCpuWorkers(budget, std::min(num_threads, num_images));
    AddCpuWorkers(num_workers, plan, num_threads, &result);
    max_num_loaders =
        (num_workers + kCpuWorkersPerLoader - 1) / kCpuWorkersPerLoader;
  } else {
    // More threads than cores, and as many again that write (see
    // MainMemoryDivision): most of the time they wait for each other, for the
    // GPU or for the disk, at different places in each pass.
    max_num_loaders = std::clamp(
        num_threads * 5 / 4,
        1,
        std::min(num_images, kLoadersPerGpu * static_cast<int>(opened.size())));
    AddGpuWorkers(std::move(opened), plan, &result);
    result.finds_scenes_ahead = true;
  }
  const MainMemoryDivision::Sizes sizes = division.Divide(
      budget, static_cast<int>(result.workers.size()), max_num_loaders);
  result.sizes = sizes.pipeline;
  result.cache_num_bytes = sizes.view_bytes;
  return result;
}

ModelResources PlanModelPass(const DeviceOptions& options,
                             const MemoryPlan& plan,
                             int64_t machine_bytes) {
  const MemoryBudget budget(options.cache_size, machine_bytes);
  ModelResources resources;
  resources.num_threads = NumThreads(options.num_threads);
  const auto at_a_time = [&](int64_t bytes) {
    return static_cast<int>(
        std::clamp<int64_t>(budget.NumBytes() / std::max<int64_t>(bytes, 1),
                            1,
                            resources.num_threads));
  };
  resources.num_blocks = at_a_time(plan.model_block);
  resources.num_views = at_a_time(plan.label_view);
  resources.max_kept_bytes = std::max<int64_t>(
      budget.NumBytes() - resources.num_views * plan.label_view, 0);
  return resources;
}

void AddGpus(const std::vector<GpuWorkers>& gpus,
             const MemoryPlan& plan,
             ModelResources* resources) {
  resources->max_gpu_bytes = std::numeric_limits<int64_t>::max();
  for (const GpuWorkers& gpu : gpus) {
    for (const std::unique_ptr<Device>& device : gpu.devices) {
      resources->gpus.push_back({gpu.name, device.get()});
    }
    // The pass uses no uploaded views.
    const auto num_devices = static_cast<int>(gpu.devices.size());
    resources->max_gpu_bytes = std::min(
        {resources->max_gpu_bytes,
         gpu.bytes_per_device,
         (DeviceBytes(plan, num_devices) - SharedViewBytes(plan, num_devices)) /
             num_devices});
  }
}

std::vector<RunSummary::GpuMemory> PeakGpuMemory(const RefineDevices& devices) {
  std::vector<RunSummary::GpuMemory> peaks;
  for (const RefineWorker& worker : devices.workers) {
    const size_t num_bytes = worker.device->PeakMemory();
    if (num_bytes > 0 && (peaks.empty() || peaks.back().gpu != worker.name)) {
      peaks.push_back({worker.name, num_bytes});
    }
  }
  return peaks;
}

}  // namespace tsar
