// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/run/device_options.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace tsar {

// The GPUs of the machine, for tests to replace.
struct GpuSystem {
  // Not called if the user demands the CPU: the call initializes the driver,
  // which costs time, address space and threads.
  std::function<int()> count;
  std::function<std::unique_ptr<Device>(int gpu_index)> create;

  static GpuSystem Cuda();
};

// A GPU of a run, with one device for each image that it works on at a time.
struct GpuWorkers {
  std::string name;  // "GPU 1 (NVIDIA H200)"
  int index = 0;
  std::vector<std::unique_ptr<Device>> devices;
  int64_t free_bytes = 0;  // Before it was used.
};

// Images that a GPU works on at a time: some are copied while one is computed.
constexpr int kMaxGpuWorkers = 8;

// Begins to initialize the GPUs of a run, which takes a good part of a second,
// in a thread: start it before inputs are read. Does nothing for the CPU.
// OpenGpus reports GPUs that fail.
[[nodiscard]] std::jthread BeginPreparingGpus(const DeviceOptions& options);

// The GPUs to work with, each of which gets at least one image; none where the
// CPU is to be used. image_bytes: the GPU memory that an image at work takes.
// OpenPipelineDevices describes which GPUs are left out, the warnings and the
// errors.
std::vector<GpuWorkers> OpenGpus(const DeviceOptions& options,
                                 int64_t image_bytes,
                                 int num_images,
                                 const GpuSystem& gpus);

}  // namespace tsar
