// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/sparse_model.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

struct ListedImage {
  int image = 0;  // Index into SparseModel::images.
  int line = 0;   // Counted from 1.
};

// Reads a text file with one image name per line, as COLMAP's image_list_path.
// Blank lines, blanks around names and line ends of any system are ignored.
// option: the option that names the file. Throws Error: kNotFound (it cannot be
// read), kCorrupt (a line is no text), kMismatch (a line names no image of the
// model, or none does), with the number of the line.
std::vector<ListedImage> ReadImageList(const std::filesystem::path& path,
                                       const SparseModel& model,
                                       const std::string& option);

}  // namespace tsar
