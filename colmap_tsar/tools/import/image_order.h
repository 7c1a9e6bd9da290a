// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/import/match_images.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// The trailing number of a name: 12 for "2333_00000012".
std::optional<int> TrailingNumber(const std::string& name);

// The images 0, 1, 2, ... of another program as indices into
// SparseModel::images. Throws Error: kNotFound (there is no list), kMismatch
// (the list is empty, or a line names no image of the model or one twice).
std::vector<int> OrderImages(const MatchOptions& options,
                             const SparseModel& model);

// The image at this index. Throws Error kMismatch with the path that has the
// index if there are fewer images.
int ImageOfNumber(const std::vector<int>& order,
                  int number,
                  const std::filesystem::path& path);

}  // namespace tsar
