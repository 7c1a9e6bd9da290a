// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/sparse_model.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// What in a sparse model COLMAP's stereo_fusion stumbles over where this
// library does not, a line for users each: coordinates far from the origin,
// which single precision rounds by a quarter of a pixel and more, and names of
// images with spaces where the model is text. sparse_folder: where it was read.
std::vector<std::string> FindFusionObstacles(
    const SparseModel& model, const std::filesystem::path& sparse_folder);

}  // namespace tsar
