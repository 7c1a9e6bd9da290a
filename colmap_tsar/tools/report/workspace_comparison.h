// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/report/comparison_picture.h"

#include <vector>

namespace tsar {

// At most `count` evenly spaced elements, including the first.
std::vector<int> PickEvenly(const std::vector<int>& values, int count);

// Reads the data of one refined image's row. Throws Error: kMismatch (the files
// differ in size, or the original is lost), and those of the readers.
ComparisonRow ReadComparisonRow(const Workspace& workspace, int image);

}  // namespace tsar
