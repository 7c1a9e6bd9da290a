// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/sparse_model.h"

#include <filesystem>

namespace tsar {

// The folder that holds the sparse model of a dense workspace: `sparse`, where
// image_undistorter writes it, or `sparse/0`, where programs that train on
// undistorted images keep it. The first is used if it has any file of a model.
// Throws Error: kNotFound (no folder `sparse`, no model in either, or only some
// of its files).
std::filesystem::path FindModelFolder(const std::filesystem::path& root);

// Reads the model in that folder. Throws Error: kUnsupported (an image's name
// leaves the workspace), and those of ReadSparseModel.
SparseModel ReadWorkspaceModel(const std::filesystem::path& model_folder);

}  // namespace tsar
