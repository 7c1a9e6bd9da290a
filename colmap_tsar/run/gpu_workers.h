// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/memory_plan.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// One image is copied while another is computed.
constexpr int kMaxGpuWorkers = 2;

// The GPUs of the machine, for tests to replace.
struct GpuSystem {
  // Asked where the CPU alone is not what the user wants: the answer has the
  // driver set itself up, which takes its time, addresses and threads.
  std::function<int()> count;
  std::function<std::unique_ptr<Device>(int gpu_index)> create;
  // Called once before these are created.
  std::function<void(const std::vector<int>& gpu_indices)> prepare =
      [](const std::vector<int>&) {};

  static GpuSystem Cuda();
};

// A GPU of a run, with one device for each image that it works on at a time.
struct GpuWorkers {
  std::string name;  // "GPU 1 (NVIDIA H200)"
  int index = 0;
  std::vector<std::unique_ptr<Device>> devices;
  // Each device's part of the memory that was free.
  int64_t bytes_per_device = 0;
};

// How many workers a GPU gets: kMaxGpuWorkers, or as many as fit. Throws
// kDevice, with what the user can do, where not even one does. gpu: what the
// message calls it.
int NumGpuWorkers(const MemoryPlan& plan,
                  int64_t free_bytes,
                  const std::string& gpu);

// The GPUs to work with, none of which stays without an image; none at all
// where the CPU is to be used. What is left out, warned of and thrown: see
// CreateRefineDevices.
std::vector<GpuWorkers> OpenGpus(const DeviceOptions& options,
                                 const MemoryPlan& plan,
                                 int num_images,
                                 const GpuSystem& gpus);

}  // namespace tsar
