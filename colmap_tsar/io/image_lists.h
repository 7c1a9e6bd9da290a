// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/sparse_model.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// Text files that name images of the sparse model.

struct ListedImage {
  int image = 0;  // Index into SparseModel::images.
  int line = 0;   // Counted from 1.
};

// Reads a text file with one image name per line, as COLMAP's image_list_path.
// Blank lines, blanks around names and line ends of any system are ignored.
// option: the option that names the file. Throws Error: kNotFound (there is
// none), kIo (it cannot be read), kCorrupt (a line is not text), kMismatch (a
// line names no image of the model, or none does), with the number of the line.
std::vector<ListedImage> ReadImageList(const std::filesystem::path& path,
                                       const SparseModel& model,
                                       const std::string& option);

// One depth map to estimate: indices into SparseModel::images.
struct StereoProblem {
  int reference = -1;
  // Sources in the file's order, or by descending number of shared points. May
  // be empty for the reason without_sources.
  std::vector<int> sources;
  std::string without_sources;
};

// Reads stereo/patch-match.cfg: pairs of lines, the reference image and its
// sources: `__all__`, `__auto__, N` (see SourceSelector) or a list of names.
// Blank lines and lines that begin with '#' are skipped. Sources that are not
// independent (see SourceSelector) are left out.
//
// Throws Error: kNotFound (no such file), kIo, kMismatch (an image that the
// sparse model does not hold), kCorrupt (a reference without sources, twice, or
// among its own sources; a bad N). Messages name the line.
std::vector<StereoProblem> ReadPatchMatchConfig(
    const std::filesystem::path& path,
    const SparseModel& model,
    double min_triangulation_angle_degrees = 1.0);

}  // namespace tsar
