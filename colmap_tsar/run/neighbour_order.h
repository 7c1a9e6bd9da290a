// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <vector>

namespace tsar {

// Images of a run are given by their places in Workspace::Problems() here.

// For each image, in ascending order, those that it reads or that read it.
std::vector<std::vector<size_t>> FindNeighbours(const Workspace& workspace);

// An order of all images in which neighbours are close to each other: that of
// Cuthill and McKee, in which images far from the first come late and those
// with few neighbours before others. Images that are connected by no chain of
// neighbours are not mixed. Depends on nothing but the neighbours and the
// images' names.
std::vector<size_t> OrderByNeighbours(const Workspace& workspace);

}  // namespace tsar
