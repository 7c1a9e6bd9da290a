// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The content of the files of a sparse model before ids are resolved and values
// checked.
struct SparseModelFiles {
  struct FileCamera {
    std::string model;
    uint64_t width = 0;
    uint64_t height = 0;
    std::vector<double> params;
  };
  struct FileImage {
    uint32_t id = 0;
    double quaternion[4] = {};  // w, x, y, z
    double translation[3] = {};
    uint32_t camera_id = 0;
    std::string name;
    int index_in_file = 0;
  };
  struct FilePoint {
    uint64_t id = 0;
    Eigen::Vector3d position;
    // The range [begin, end) in track_image_ids.
    size_t track_begin = 0;
    size_t track_end = 0;
  };

  std::filesystem::path cameras_path;
  std::filesystem::path images_path;
  std::filesystem::path points_path;

  std::unordered_map<uint32_t, FileCamera> cameras;
  std::vector<FileImage> images;
  std::vector<FilePoint> points;
  std::vector<uint32_t> track_image_ids;
};

// Reads the files of cameras, images and points: binary if the first ends in
// .bin, otherwise text. Throws Error kCorrupt, kUnsupported or kIo.
SparseModelFiles ReadSparseModelFiles(
    const std::array<std::filesystem::path, 3>& paths);

// The error kCorrupt for a file of the model.
Error CorruptModel(const std::filesystem::path& path, const std::string& what);

}  // namespace tsar
