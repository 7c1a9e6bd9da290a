// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace tsar {

// Calls function(i) for each index i in `images`, from several threads;
// rethrows the first exception. For work that holds all maps of an image.
// num_threads: -1 for one per core; fewer where the images are so large that
// half of the main memory would not suffice.
void ForEachImage(const Workspace& workspace,
                  const std::vector<int>& images,
                  int num_threads,
                  const std::function<void(size_t)>& function);

}  // namespace tsar
