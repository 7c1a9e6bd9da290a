// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/pipeline/refine_workspace.h"
#include "colmap_tsar/pipeline/workspace_check.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// The devices of a run, each of which works on one image at a time, and how
// many bytes of views may be kept beside them.
struct RefineDevices {
  std::string description;  // "2 CPU threads", or the GPU's name.
  std::vector<std::unique_ptr<Device>> devices;
  size_t cache_num_bytes = 0;
};

// On CPUs images are spread over the threads before the loops of an image are:
// images need not wait for each other. Throws kDevice.
RefineDevices CreateRefineDevices(const WorkspaceRefineOptions& options,
                                  const WorkspaceOverview& overview,
                                  int num_images);

}  // namespace tsar
