// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/gpu_workers.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/start_thread.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/memory_plan.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace tsar {
namespace {

// Memory besides the stages' buffers: the kernels, which the driver loads when
// they are first used.
constexpr int64_t kDriverBytes = int64_t{64} << 20;

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

// The memory of a GPU that works on so many images at a time.
int64_t NeededBytes(int num_images, int64_t image_bytes) {
  return num_images * (image_bytes + kDriverBytes);
}

// A GPU with one device. Throws kDevice where not even one image fits.
GpuWorkers OpenGpu(int index,
                   std::unique_ptr<Device> device,
                   int64_t image_bytes) {
  GpuWorkers gpu;
  gpu.index = index;
  gpu.name = "GPU " + std::to_string(index) + " (" + device->Name() + ")";
  gpu.free_bytes = static_cast<int64_t>(
      std::min(device->FreeMemory(), static_cast<size_t>(INT64_MAX)));
  gpu.devices.push_back(std::move(device));
  if (NeededBytes(1, image_bytes) > gpu.free_bytes) {
    throw Error(
        ErrorCode::kDevice,
        gpu.name + ": an image of this workspace needs " +
            Gigabytes(NeededBytes(1, image_bytes)) + " of GPU memory and " +
            Gigabytes(gpu.free_bytes) +
            " are free; close other programs that use the GPU, choose another "
            "one with " +
            OptionName("gpu_index") +
            ", run patch_match_stereo with a "
            "smaller --PatchMatchStereo.max_image_size, or pass " +
            OptionName("device") + " cpu");
  }
  return gpu;
}

// Opens GPUs until there is one for each image; none where the CPU is to be
// used instead. The failure of a GPU that the user named is an error. Too
// little memory is an error even with device "auto": the CPU would take a
// hundred times as long.
std::vector<GpuWorkers> OpenWithOneDevice(const std::vector<int>& wanted,
                                          bool are_named,
                                          bool is_auto,
                                          int64_t image_bytes,
                                          int num_images,
                                          const GpuSystem& gpus) {
  std::vector<GpuWorkers> opened;
  std::optional<Error> not_opened;
  std::optional<Error> too_small;
  std::vector<std::string> warnings;
  for (const int index : wanted) {
    if (static_cast<int>(opened.size()) == num_images) {
      break;
    }
    bool exists = false;
    try {
      std::unique_ptr<Device> device = gpus.create(index);
      exists = true;
      opened.push_back(OpenGpu(index, std::move(device), image_bytes));
    } catch (const Error& error) {
      if (are_named) {
        throw;
      }
      std::optional<Error>& first = exists ? too_small : not_opened;
      if (!first) {
        first = error;
      }
      warnings.push_back(error.what());
    }
  }
  if (opened.empty() && too_small) {
    throw Error(*too_small);
  }
  if (opened.empty() && not_opened && !is_auto) {
    throw Error(*not_opened);
  }
  for (const std::string& warning : warnings) {
    Warn(warning);
  }
  return opened;
}

// Gives each GPU as many further devices as its memory allows, as long as
// images are left.
void AddDevices(int64_t image_bytes,
                int num_images,
                const GpuSystem& gpus,
                std::vector<GpuWorkers>* opened) {
  int num_left = num_images - static_cast<int>(opened->size());
  for (int count = 2; count <= kMaxGpuWorkers; ++count) {
    for (GpuWorkers& gpu : *opened) {
      if (num_left <= 0 || static_cast<int>(gpu.devices.size()) < count - 1 ||
          NeededBytes(count, image_bytes) > gpu.free_bytes) {
        continue;
      }
      try {
        gpu.devices.push_back(gpus.create(gpu.index));
        --num_left;
      } catch (const Error& error) {
        Warn(error.what() + ("; " + gpu.name) + " works on " +
             std::to_string(count - 1) +
             (count == 2 ? " image at a time" : " images at a time"));
      }
    }
  }
}

}  // namespace

GpuSystem GpuSystem::Cuda() {
  return {&Device::NumCudaDevices, &Device::CreateCuda};
}

std::jthread BeginPreparingGpus(const DeviceOptions& options) {
  if (options.choice == DeviceChoice::kCpu) {
    return {};
  }
  return StartThread([indices = options.gpu_indices] {
    try {
      Device::PrepareCudaDevices(indices);
    } catch (...) {
      // No memory or no thread for a GPU: it is initialized when it is opened.
    }
  });
}

std::vector<GpuWorkers> OpenGpus(const DeviceOptions& options,
                                 int64_t image_bytes,
                                 int num_images,
                                 const GpuSystem& gpus) {
  if (options.choice == DeviceChoice::kCpu) {
    return {};
  }
  const bool is_auto = options.choice == DeviceChoice::kAuto;
  const std::vector<int>& named = options.gpu_indices;
  const int num_gpus = gpus.count();
  if (num_gpus == 0 && !is_auto) {
    // Throws the reason.
    gpus.create(named.empty() ? 0 : named[0]);
  }
  std::vector<GpuWorkers> opened;
  if (num_gpus > 0) {
    const std::vector<int> wanted = WantedGpus(named, num_gpus);
    opened = OpenWithOneDevice(
        wanted, !named.empty(), is_auto, image_bytes, num_images, gpus);
  }
  if (opened.empty()) {
    Warn((named.empty() ? "" : OptionName("gpu_index") + ": ") +
         "there is no GPU that can be used; going on with the CPU");
  }
  AddDevices(image_bytes, num_images, gpus, &opened);
  return opened;
}

}  // namespace tsar
