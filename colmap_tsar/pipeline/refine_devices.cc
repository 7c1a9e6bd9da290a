// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/refine_devices.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <thread>
#include <utility>

#include <glog/logging.h>

namespace tsar {
namespace {

constexpr double kBytesPerGigabyte = 1e9;

// A view in the cache with its exported costs; the reference with all that the
// stages make of it, of which about 110 were measured; and a source's gray and
// depth on the device.
constexpr int64_t kBytesPerViewPixel = 31;
constexpr int64_t kBytesPerReferencePixel = 256;
constexpr int64_t kBytesPerSourcePixel = 8;

int64_t WorkBytes(const WorkspaceOverview& overview) {
  return overview.max_num_pixels *
         (kBytesPerReferencePixel +
          kBytesPerSourcePixel * overview.max_num_sources);
}

int64_t ViewBytes(const WorkspaceOverview& overview) {
  return overview.max_num_pixels * kBytesPerViewPixel *
         (overview.max_num_sources + 1);
}

// The GPU to use; nothing for the CPU. A GPU that the program cannot use is an
// error only where it was asked for.
std::unique_ptr<Device> CreateGpu(const WorkspaceRefineOptions& options,
                                  int num_threads) {
  if (options.device == "cpu" ||
      (options.device == "auto" && Device::NumCudaDevices() == 0)) {
    return nullptr;
  }
  try {
    return Device::CreateCuda(std::max(options.gpu_index, 0), num_threads);
  } catch (const Error& error) {
    if (options.device == "cuda") {
      throw;
    }
    LOG(WARNING) << error.what() << "; going on with the CPU";
    return nullptr;
  }
}

}  // namespace

RefineDevices CreateRefineDevices(const WorkspaceRefineOptions& options,
                                  const WorkspaceOverview& overview,
                                  int num_images) {
  const int num_threads =
      options.num_threads > 0
          ? options.num_threads
          : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const auto budget =
      static_cast<int64_t>(options.cache_size * kBytesPerGigabyte);
  RefineDevices result;
  if (std::unique_ptr<Device> gpu = CreateGpu(options, num_threads)) {
    result.devices.push_back(std::move(gpu));
    result.description = result.devices[0]->Name();
  } else {
    const int64_t num_that_fit =
        budget /
        std::max<int64_t>(1, WorkBytes(overview) + ViewBytes(overview));
    const int num_workers = static_cast<int>(std::clamp<int64_t>(
        num_that_fit, 1, std::min(num_threads, num_images)));
    for (int i = 0; i < num_workers; ++i) {
      const int remainder = i < num_threads % num_workers ? 1 : 0;
      result.devices.push_back(
          Device::CreateCpu(num_threads / num_workers + remainder));
    }
    result.description = std::to_string(num_threads) + " CPU thread" +
                         (num_threads == 1 ? "" : "s");
  }
  const int64_t rest = budget - WorkBytes(overview) *
                                    static_cast<int64_t>(result.devices.size());
  result.cache_num_bytes = static_cast<size_t>(std::max<int64_t>(rest, 0));
  return result;
}

}  // namespace tsar
