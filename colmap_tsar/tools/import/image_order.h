// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/import/match_images.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// The number that a name ends in: 12 for "2333_00000012".
std::optional<int> TrailingNumber(const std::string& name);

// The images 0, 1, 2, ... of another program as indices into
// SparseModel::images. Throws Error: kNotFound (there is no list), kMismatch (a
// line of it names no image of the model or one a second time; it is empty).
std::vector<int> OrderImages(const MatchOptions& options,
                             const SparseModel& model);

// The image of this number; Error kMismatch, naming the path that has it, where
// there are not as many.
int ImageOfNumber(const std::vector<int>& order,
                  int number,
                  const std::filesystem::path& path);

}  // namespace tsar
