// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/input_file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The content of the files of a sparse model before ids are resolved and values
// checked. Shared by the two formats.
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
    int place = 0;  // Index in the file.
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

// Read the files at the paths, which must be set. Throw Error kCorrupt,
// kUnsupported or kIo.
void ReadSparseModelBinary(SparseModelFiles* files);
void ReadSparseModelText(SparseModelFiles* files);

// The number of parameters of a camera model that this program can use; throws
// Error kUnsupported for the others.
int NumCameraParams(const std::filesystem::path& path,
                    const std::string& model);

// Throws Error kIo if the file at the path could not be opened.
void RequireOpened(const std::filesystem::path& path, const InputFile& file);

// Adds a camera. Throws Error kCorrupt if the id is taken.
void AddCamera(uint32_t id,
               SparseModelFiles::FileCamera camera,
               SparseModelFiles* files);

// The fields that both formats of a sparse model have in the same order.
// Reader: has Read<T>(), which returns the next field.

template <typename Reader>
void ReadCamera(uint32_t id,
                std::string model,
                Reader* reader,
                SparseModelFiles* files) {
  SparseModelFiles::FileCamera camera;
  camera.model = std::move(model);
  camera.width = reader->template Read<uint64_t>();
  camera.height = reader->template Read<uint64_t>();
  camera.params.resize(
      static_cast<size_t>(NumCameraParams(files->cameras_path, camera.model)));
  for (double& param : camera.params) {
    param = reader->template Read<double>();
  }
  AddCamera(id, std::move(camera), files);
}

// Reads all fields of an image except its name.
template <typename Reader>
void ReadPose(Reader* reader, SparseModelFiles::FileImage* image) {
  image->id = reader->template Read<uint32_t>();
  for (double& value : image->quaternion) {
    value = reader->template Read<double>();
  }
  for (double& value : image->translation) {
    value = reader->template Read<double>();
  }
  image->camera_id = reader->template Read<uint32_t>();
}

// Reads the fields of a point except its color, error and track.
template <typename Reader>
void ReadPosition(Reader* reader, SparseModelFiles::FilePoint* point) {
  point->id = reader->template Read<uint64_t>();
  for (int i = 0; i < 3; ++i) {
    point->position(i) = reader->template Read<double>();
  }
}

}  // namespace tsar
