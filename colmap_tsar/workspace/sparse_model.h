// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"

#include <filesystem>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The part of COLMAP's sparse model that dense reconstruction needs.
class SparseModel {
 public:
  struct ModelImage {
    std::string name;  // Relative to images/, with '/' between folders.
    Camera camera;
    // Indices into `points`, ascending, one per observation: a point that the
    // image sees twice is listed twice.
    std::vector<int> point_indices;
  };

  std::vector<ModelImage> images;       // By ascending COLMAP image id.
  std::vector<Eigen::Vector3d> points;  // World frame.

  // The image of this name, or nullptr, or -1.
  const ModelImage* Find(const std::string& name) const;
  int IndexOf(const std::string& name) const;

  // To be called after `images` was filled or changed.
  void IndexNames();

 private:
  std::unordered_map<std::string, int> index_of_name_;
};

// Reads cameras, images and points3D from a folder, in binary form where all
// three .bin files are there, otherwise as text; the format is the same in all
// versions of COLMAP from 3.7 on. Quaternions are normalised.
//
// Throws Error: kNotFound (no folder, or files missing), kUnsupported (a camera
// model other than PINHOLE and SIMPLE_PINHOLE), kCorrupt (anything that breaks
// the format: truncated files, counts larger than the file, ids that do not
// exist, duplicates, focal lengths that are not positive, NaN).
SparseModel ReadSparseModel(const std::filesystem::path& sparse_folder);

}  // namespace tsar
