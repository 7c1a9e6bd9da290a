// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/refine_devices.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/pipeline/gpu_indices.h"
#include "colmap_tsar/pipeline/memory_plan.h"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <thread>
#include <utility>

#include <glog/logging.h>

namespace tsar {
namespace {

constexpr double kBytesPerGigabyte = 1e9;

// Reading and writing an image each take a few times as long as a GPU computes
// on it.
constexpr int kFilesThreadsPerGpu = 4;
// A CPU computes on an image for so long that one thread keeps many supplied.
constexpr int kCpuWorkersPerFilesThread = 8;

struct Gpu {
  std::string name;
  int index = 0;
  int num_workers = 0;
  std::unique_ptr<Device> device;
};

std::string NoGpu(int index, int num_gpus) {
  return "TsarRefine.gpu_index: there is no GPU " + std::to_string(index) +
         "; this machine has " + std::to_string(num_gpus) +
         (num_gpus == 1 ? ", number 0"
                        : ", numbers 0 to " + std::to_string(num_gpus - 1));
}

// The GPUs for which a function does not throw; warnings tell about the others.
// What it throws is rethrown where the user named the GPUs, or where none is
// left and one is needed.
template <typename Function>
std::vector<Gpu> KeepUsable(std::vector<Gpu> gpus,
                            bool are_named,
                            bool is_one_needed,
                            Function function) {
  std::vector<Gpu> usable;
  std::exception_ptr failure;
  std::vector<std::string> warnings;
  for (Gpu& gpu : gpus) {
    try {
      function(&gpu);
      usable.push_back(std::move(gpu));
    } catch (const Error& error) {
      if (are_named) {
        throw;
      }
      failure = failure ? failure : std::current_exception();
      warnings.push_back(error.what());
    }
  }
  if (usable.empty() && is_one_needed && failure) {
    std::rethrow_exception(failure);
  }
  for (const std::string& warning : warnings) {
    LOG(WARNING) << warning;
  }
  return usable;
}

// The GPUs to use, each with one device; none where the CPU is to be used.
std::vector<Gpu> OpenGpus(const WorkspaceRefineOptions& options,
                          int num_threads,
                          const GpuSystem& gpus) {
  std::vector<int> indices = ParseGpuIndices(options.gpu_index);
  const bool are_named = !indices.empty();
  const bool is_auto = options.device == "auto";
  if (options.device == "cpu") {
    return {};
  }
  if (gpus.num_gpus == 0) {
    if (!is_auto) {
      // Says why there is none.
      gpus.create(are_named ? indices[0] : 0, num_threads);
    }
    LOG(WARNING) << "there is no GPU that can be used; going on with the CPU";
    return {};
  }
  if (!are_named) {
    for (int index = 0; index < gpus.num_gpus; ++index) {
      indices.push_back(index);
    }
  }
  // The loops of a GPU's worker that run on the host share the cores with
  // those of the others.
  const int num_worker_threads = std::max(
      1, num_threads / (kMaxGpuWorkers * static_cast<int>(indices.size())));
  std::vector<Gpu> opened(indices.size());
  for (size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= gpus.num_gpus) {
      throw Error(ErrorCode::kDevice, NoGpu(indices[i], gpus.num_gpus));
    }
    opened[i].index = indices[i];
  }
  opened = KeepUsable(std::move(opened), are_named, !is_auto, [&](Gpu* gpu) {
    gpu->device = gpus.create(gpu->index, num_worker_threads);
    gpu->name =
        "GPU " + std::to_string(gpu->index) + " (" + gpu->device->Name() + ")";
  });
  if (opened.empty()) {
    LOG(WARNING) << "there is no GPU that can be used; going on with the CPU";
  }
  return opened;
}

// Finds out how many workers each GPU's memory allows. That it allows none is
// an error also with device "auto": the CPU would take a hundred times as long.
std::vector<Gpu> CheckMemory(std::vector<Gpu> opened,
                             const WorkspaceRefineOptions& options,
                             const WorkspaceOverview& overview) {
  const bool are_named = !ParseGpuIndices(options.gpu_index).empty();
  return KeepUsable(std::move(opened), are_named, true, [&](Gpu* gpu) {
    const size_t free_bytes =
        std::min(gpu->device->FreeMemory(), static_cast<size_t>(INT64_MAX));
    gpu->num_workers =
        NumGpuWorkers(overview, static_cast<int64_t>(free_bytes), gpu->name);
  });
}

std::string Describe(const std::vector<Gpu>& gpus) {
  std::string text;
  for (const Gpu& gpu : gpus) {
    text += (text.empty() ? "" : ", ") + gpu.name;
  }
  return text;
}

void AddGpuWorkers(std::vector<Gpu> opened,
                   const WorkspaceOverview& overview,
                   int num_images,
                   const GpuSystem& gpus,
                   RefineDevices* result) {
  result->description = Describe(opened);
  int num_left = num_images;
  for (Gpu& gpu : opened) {
    const int num_workers = std::clamp(num_left, 1, gpu.num_workers);
    num_left -= num_workers;
    result->view_caches.push_back(std::make_unique<DeviceViewCache>(
        static_cast<size_t>(SharedViewBytes(overview, num_workers))));
    const int num_worker_threads = gpu.device->Threads().NumThreads();
    for (int i = 0; i < num_workers; ++i) {
      result->workers.push_back(
          {gpu.name,
           i == 0 ? std::move(gpu.device)
                  : gpus.create(gpu.index, num_worker_threads),
           result->view_caches.back().get()});
    }
  }
}

void AddCpuWorkers(int num_workers,
                   const WorkspaceOverview& overview,
                   int num_threads,
                   RefineDevices* result) {
  result->description = std::to_string(num_threads) + " CPU thread" +
                        (num_threads == 1 ? "" : "s");
  result->view_caches.push_back(std::make_unique<DeviceViewCache>(
      static_cast<size_t>(SharedViewBytes(overview, num_workers))));
  for (int i = 0; i < num_workers; ++i) {
    const int remainder = i < num_threads % num_workers ? 1 : 0;
    result->workers.push_back(
        {"the CPU",
         Device::CreateCpu(num_threads / num_workers + remainder),
         result->view_caches.back().get()});
  }
}

}  // namespace

GpuSystem GpuSystem::Cuda() {
  return {Device::NumCudaDevices(), &Device::CreateCuda};
}

RefineDevices CreateRefineDevices(const WorkspaceRefineOptions& options,
                                  const WorkspaceOverview& overview,
                                  int num_images,
                                  const GpuSystem& gpus) {
  const int num_threads =
      options.num_threads > 0
          ? options.num_threads
          : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const auto budget =
      static_cast<int64_t>(options.cache_size * kBytesPerGigabyte);
  RefineDevices result;
  int64_t work_bytes = 0;
  std::vector<Gpu> opened =
      CheckMemory(OpenGpus(options, num_threads, gpus), options, overview);
  if (!opened.empty()) {
    const int num_files_threads = std::clamp(
        num_threads / 3,
        1,
        std::min(num_images,
                 kFilesThreadsPerGpu * static_cast<int>(opened.size())));
    AddGpuWorkers(std::move(opened), overview, num_images, gpus, &result);
    result.sizes = {num_files_threads,
                    num_files_threads,
                    result.workers.size(),
                    static_cast<size_t>(num_files_threads)};
  } else {
    const int64_t bytes_for_one =
        WorkBytes(overview) +
        (overview.max_num_sources + 1) * ViewBytes(overview);
    const int num_workers = static_cast<int>(
        std::clamp<int64_t>(budget / std::max<int64_t>(1, bytes_for_one),
                            1,
                            std::min(num_threads, num_images)));
    AddCpuWorkers(num_workers, overview, num_threads, &result);
    const int num_files_threads =
        (num_workers + kCpuWorkersPerFilesThread - 1) /
        kCpuWorkersPerFilesThread;
    result.sizes = {num_files_threads, num_files_threads, 1, 1};
    work_bytes = num_workers * WorkBytes(overview);
  }
  // A result is with a worker, waits, or is being written.
  const auto num_results =
      static_cast<int64_t>(result.workers.size() + result.sizes.max_finished) +
      result.sizes.num_writers;
  const int64_t rest =
      budget - work_bytes - num_results * ResultBytes(overview);
  result.cache_num_bytes = static_cast<size_t>(std::max<int64_t>(rest, 0));
  return result;
}

}  // namespace tsar
