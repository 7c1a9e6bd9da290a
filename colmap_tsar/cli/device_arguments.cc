// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/device_arguments.h"

namespace tsar {

DeviceOptions DeviceArguments::Parse() const {
  DeviceOptions options;
  options.choice = ParseDeviceChoice(device);
  options.gpu_indices = ParseGpuIndices(gpu_index);
  options.num_threads = num_threads;
  options.cache_size = cache_size;
  options.Check();
  return options;
}

void AddDeviceArguments(const std::string& group,
                        DeviceArguments* arguments,
                        OptionSet* options) {
  options->AddChoice(group + "device",
                     &arguments->device,
                     {"auto", "cuda", "cpu"},
                     "Where to compute; auto: on a GPU where there is one.");
  options->Add(group + "gpu_index",
               &arguments->gpu_index,
               "The GPUs to use, as numbers from 0 on with commas between "
               "them, such as 0,1; -1 takes every GPU of the machine.");
  options->Add(group + "cache_size",
               &arguments->cache_size,
               "Main memory for the images at work, in gigabytes; at most four "
               "fifths of the machine's count. Fewer images are worked on at a "
               "time where it does not suffice.",
               {0.001, 1e6});
}

}  // namespace tsar
