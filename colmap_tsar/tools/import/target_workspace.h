// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/io/sparse_model.h"

#include <filesystem>

namespace tsar {

// Reads the sparse model of a workspace of which only images/ and sparse/ need
// exist. Throws Error: kNotFound (one is missing or empty), kUnsupported (an
// image's name leaves the folder), those of ReadSparseModel.
SparseModel ReadTargetModel(const std::filesystem::path& root);

// Gives an empty folder what COLMAP's dense stage needs beside maps: the photos
// of the model's images, as hard links where the file system allows, a copy of
// the model's files, and configuration files with all images and `__auto__,
// 20`. Photos that are missing are left out. Throws Error kIo.
void WriteInputs(const std::filesystem::path& source,
                 const SparseModel& model,
                 const ContainedPath& root);

}  // namespace tsar
