// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/device_options.h"

namespace tsar {

void AddDeviceOptions(const std::string& group,
                      WorkspaceRefineOptions* run,
                      OptionSet* options) {
  options->AddChoice(group + "device",
                     &run->device,
                     {"auto", "cuda", "cpu"},
                     "Where to compute; auto: on a GPU where there is one.");
  options->Add(group + "gpu_index",
               &run->gpu_index,
               "The GPUs to use, as numbers from 0 on with commas between "
               "them, such as 0,1; -1 takes every GPU of the machine.");
  options->Add(group + "cache_size",
               &run->cache_size,
               "Main memory for the images at work, in gigabytes; at most four "
               "fifths of the machine's count. Fewer images are worked on at a "
               "time where it does not suffice.",
               {0.001, 1e6});
}

}  // namespace tsar
