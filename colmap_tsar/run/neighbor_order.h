// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <vector>

namespace tsar {

// A Cuthill-McKee order of all images, given by their indices in
// Workspace::Problems(), in which neighbors are close to each other: images far
// from the first come late, those with few neighbors before others. Connected
// components are not mixed. The order depends only on the neighbors and the
// images' names.
std::vector<size_t> OrderByNeighbors(const Workspace& workspace);

}  // namespace tsar
