// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/gpu_workers.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/warning.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <optional>
#include <utility>

namespace tsar {
namespace {

// Memory beside the stages' buffers: the kernels, which the driver loads when
// they are first used.
constexpr int64_t kDriverBytes = int64_t{64} << 20;

struct Gpu {
  GpuWorkers workers;
  int64_t free_bytes = 0;
  int max_num_workers = 0;  // The largest number that its memory allows.
};

std::string Gigabytes(int64_t num_bytes) {
  char text[64];
  std::snprintf(
      text, sizeof(text), "%.1f GB", static_cast<double>(num_bytes) / 1e9);
  return text;
}

std::string NoGpu(int index, int num_gpus) {
  return OptionName("gpu_index") + ": there is no GPU " +
         std::to_string(index) + "; this machine has " +
         std::to_string(num_gpus) +
         (num_gpus == 1 ? ", number 0"
                        : ", numbers 0 to " + std::to_string(num_gpus - 1));
}

// The GPUs to try, in their order.
std::vector<int> WantedGpus(const std::vector<int>& named, int num_gpus) {
  std::vector<int> indices = named;
  if (named.empty()) {
    indices.resize(static_cast<size_t>(num_gpus));
    std::iota(indices.begin(), indices.end(), 0);
  }
  for (const int index : indices) {
    if (index >= num_gpus) {
      throw Error(ErrorCode::kDevice, NoGpu(index, num_gpus));
    }
  }
  return indices;
}

// Calls a function and returns its Error, or nothing.
template <typename Function>
std::optional<Error> Attempt(Function function) {
  try {
    function();
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

// The number of workers of a GPU: kMaxGpuWorkers, or as many as fit. Throws
// kDevice where not even one fits.
int NumGpuWorkers(const MemoryPlan& plan,
                  int64_t free_bytes,
                  const std::string& gpu) {
  const auto needed = [&](int num_workers) {
    return DeviceBytes(plan, num_workers) + num_workers * kDriverBytes;
  };
  if (needed(1) > free_bytes) {
    throw Error(
        ErrorCode::kDevice,
        gpu + ": an image of this workspace needs " + Gigabytes(needed(1)) +
            " of GPU memory and " + Gigabytes(free_bytes) +
            " are free; close other programs that use the GPU, choose another "
            "one with " +
            OptionName("gpu_index") +
            ", run patch_match_stereo with a "
            "smaller --PatchMatchStereo.max_image_size, or pass " +
            OptionName("device") + " cpu");
  }
  int num_workers = kMaxGpuWorkers;
  while (needed(num_workers) > free_bytes) {
    --num_workers;
  }
  return num_workers;
}

// Opens GPUs, each with one device, until there is one for each image.
class GpuOpener {
 public:
  GpuOpener(const MemoryPlan& plan, const GpuSystem& gpus, bool are_named)
      : plan_(plan), gpus_(gpus), are_named_(are_named) {}

  void Open(int index) {
    Gpu gpu;
    gpu.workers.index = index;
    std::vector<std::unique_ptr<Device>>& devices = gpu.workers.devices;
    const auto open = [&] {
      devices.push_back(gpus_.create(index));
      gpu.workers.name =
          "GPU " + std::to_string(index) + " (" + devices[0]->Name() + ")";
    };
    const auto plan = [&] {
      gpu.free_bytes = static_cast<int64_t>(
          std::min(devices[0]->FreeMemory(), static_cast<size_t>(INT64_MAX)));
      gpu.max_num_workers =
          NumGpuWorkers(plan_, gpu.free_bytes, gpu.workers.name);
    };
    if (Keep(Attempt(open), &not_opened_) && Keep(Attempt(plan), &too_small_)) {
      opened_.push_back(std::move(gpu));
    }
  }

  size_t NumOpened() const { return opened_.size(); }

  // Returns no GPU where the CPU is to be used instead. Throws where a GPU is
  // needed. GPUs with too little memory are an error also with device "auto":
  // the CPU would take a hundred times as long.
  std::vector<Gpu> Take(bool is_auto) {
    if (opened_.empty() && too_small_) {
      throw Error(*too_small_);
    }
    if (opened_.empty() && not_opened_ && !is_auto) {
      throw Error(*not_opened_);
    }
    for (const std::string& warning : warnings_) {
      Warn(warning);
    }
    return std::move(opened_);
  }

 private:
  // Returns whether there was no failure, and remembers the first of its kind.
  // Throws the failure of a GPU that the user named.
  bool Keep(const std::optional<Error>& failure, std::optional<Error>* first) {
    if (!failure) {
      return true;
    }
    if (are_named_) {
      throw Error(*failure);
    }
    if (!*first) {
      first->emplace(*failure);
    }
    warnings_.push_back(failure->what());
    return false;
  }

  const MemoryPlan& plan_;
  const GpuSystem& gpus_;
  const bool are_named_;
  std::vector<Gpu> opened_;
  std::optional<Error> not_opened_;
  std::optional<Error> too_small_;
  std::vector<std::string> warnings_;
};

// The GPUs to use, each with one device; none where the CPU is to be used.
std::vector<Gpu> OpenWithOneDevice(const std::vector<int>& named,
                                   bool is_auto,
                                   const MemoryPlan& plan,
                                   int num_images,
                                   const GpuSystem& gpus) {
  const int num_gpus = gpus.count();
  if (num_gpus == 0 && !is_auto) {
    // Throws the reason.
    gpus.create(named.empty() ? 0 : named[0]);
  }
  std::vector<Gpu> opened;
  if (num_gpus > 0) {
    GpuOpener opener(plan, gpus, !named.empty());
    const std::vector<int> wanted = WantedGpus(named, num_gpus);
    if (static_cast<int>(wanted.size()) <= num_images) {
      gpus.prepare(wanted);
    }
    for (const int index : wanted) {
      if (static_cast<int>(opener.NumOpened()) < num_images) {
        opener.Open(index);
      }
    }
    opened = opener.Take(is_auto);
  }
  if (opened.empty()) {
    Warn((named.empty() ? "" : OptionName("gpu_index") + ": ") +
         "there is no GPU that can be used; going on with the CPU");
  }
  return opened;
}

// Gives GPUs further devices, one after the other, as long as images are left.
void AddDevices(int num_images,
                const GpuSystem& gpus,
                std::vector<Gpu>* opened) {
  int num_left = num_images - static_cast<int>(opened->size());
  for (int round = 1; round < kMaxGpuWorkers; ++round) {
    for (Gpu& gpu : *opened) {
      if (num_left <= 0 || gpu.max_num_workers <= round) {
        continue;
      }
      GpuWorkers& workers = gpu.workers;
      const auto failure = Attempt(
          [&] { workers.devices.push_back(gpus.create(workers.index)); });
      if (failure) {
        Warn(failure->what() + ("; " + workers.name) + " works on " +
             std::to_string(workers.devices.size()) + " image at a time");
        gpu.max_num_workers = round;
      } else {
        --num_left;
      }
    }
  }
}

}  // namespace

GpuSystem GpuSystem::Cuda() {
  return {&Device::NumCudaDevices,
          &Device::CreateCuda,
          &Device::PrepareCudaDevices};
}

std::vector<GpuWorkers> OpenGpus(const DeviceOptions& options,
                                 const MemoryPlan& plan,
                                 int num_images,
                                 const GpuSystem& gpus) {
  if (options.choice == DeviceChoice::kCpu) {
    return {};
  }
  std::vector<Gpu> opened =
      OpenWithOneDevice(options.gpu_indices,
                        options.choice == DeviceChoice::kAuto,
                        plan,
                        num_images,
                        gpus);
  AddDevices(num_images, gpus, &opened);
  std::vector<GpuWorkers> workers;
  for (Gpu& gpu : opened) {
    gpu.workers.bytes_per_device =
        gpu.free_bytes / static_cast<int64_t>(gpu.workers.devices.size()) -
        kDriverBytes;
    workers.push_back(std::move(gpu.workers));
  }
  return workers;
}

}  // namespace tsar
