// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

namespace tsar {

enum class DeviceChoice {
  kAuto,  // GPUs if there are any, else the CPU.
  kCuda,
  kCpu,
};

// "auto", "cuda" or "cpu".
std::string ToString(DeviceChoice choice);

// Reads "0,1,3"; nothing for "-1", which stands for every GPU. Throws
// kBadOption, naming the option "gpu_index", for anything else.
std::vector<int> ParseGpuIndices(const std::string& text);
std::string GpuIndicesText(const std::vector<int>& gpu_indices);

// The devices and the memory of a run; nothing here changes a result.
struct DeviceOptions {
  DeviceChoice choice = DeviceChoice::kAuto;
  std::vector<int> gpu_indices;  // In CUDA's order; empty: every GPU.
  int num_threads = -1;          // -1: one for each core.
  double cache_size = 32.0;  // Main memory for images at work, in gigabytes.

  // Throws kBadOption, naming the option.
  void Check() const;
};

}  // namespace tsar
