// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/controllers/device_options.h"

#include <string>

namespace tsar {

// DeviceOptions as a user types them.
struct DeviceArguments {
  std::string device = ToString(DeviceOptions().choice);
  std::string gpu_index = GpuIndicesText(DeviceOptions().gpu_indices);
  int num_threads = DeviceOptions().num_threads;
  double cache_size = DeviceOptions().cache_size;

  // Throws kBadOption.
  DeviceOptions Parse() const;
};

// Adds the options by which a command is told where to compute and how much
// memory to take; that of num_threads, which each command describes itself, is
// left to the caller. group: what their names begin with, such as
// "TsarRefine.".
void AddDeviceArguments(const std::string& group,
                        DeviceArguments* arguments,
                        OptionSet* options);

}  // namespace tsar
