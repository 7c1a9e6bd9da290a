// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/workspace/sparse_model.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// One depth map to work on: indices into SparseModel::images.
struct StereoProblem {
  int reference = -1;
  // In the file's order, or by falling number of shared points; may be empty
  // where `__auto__` finds no image.
  std::vector<int> sources;
};

// Reads stereo/patch-match.cfg: pairs of lines, the reference image and its
// sources: `__all__`, `__auto__, N` (see SelectSources) or a list of names.
// Blank lines and lines that begin with '#' are skipped.
//
// Throws Error: kNotFound (no such file), kMismatch (an image that the sparse
// model does not hold), kCorrupt (a reference without sources, twice, or among
// its own sources; a bad N). Messages name the line.
std::vector<StereoProblem> ReadPatchMatchConfig(
    const std::filesystem::path& path,
    const SparseModel& model,
    double min_triangulation_angle_degrees = 1.0);

}  // namespace tsar
