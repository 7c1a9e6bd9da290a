// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/io/sparse_model.h"

#include <filesystem>

namespace tsar {

// Reads the sparse model of a target workspace, of which only images/ and
// sparse/ need exist. Throws Error: kNotFound (one is missing or empty),
// kUnsupported (an image's name leaves the folder), those of ReadSparseModel.
SparseModel ReadTargetModel(const std::filesystem::path& root);

// Creates the folder stereo if missing; removes it again if it stays empty.
class StereoFolder {
 public:
  explicit StereoFolder(const std::filesystem::path& root);
  ~StereoFolder();
  StereoFolder(const StereoFolder&) = delete;
  StereoFolder& operator=(const StereoFolder&) = delete;

 private:
  ContainedPath path_;
  bool is_new_ = false;
};

// Writes missing patch-match.cfg and fusion.cfg: all images, `__auto__, 20`.
void WriteMissingConfigs(const std::filesystem::path& root,
                         const SparseModel& model);

}  // namespace tsar
