// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace tsar {

// Calls function(i) for each of these images, i its place in the list, from
// several threads; the first exception is rethrown. For work that holds all
// maps of an image. num_threads: -1 for one for each core; fewer where images
// are so large that half of the main memory would not bear as many.
void ForEachImage(const Workspace& workspace,
                  const std::vector<int>& images,
                  int num_threads,
                  const std::function<void(size_t)>& function);

}  // namespace tsar
