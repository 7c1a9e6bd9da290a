// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace tsar {

// The number of the images, indices in the sparse model, that have a mask;
// nothing where the workspace uses no masks.
std::optional<int64_t> CountMasks(const Workspace& workspace,
                                  const std::vector<int>& images);

// The references of the problems, in their order.
std::vector<int> ReferencesOf(const Workspace& workspace,
                              const std::vector<size_t>& problems);

}  // namespace tsar
