// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/workspace/sparse_model_files.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace tsar {

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

// All of an image but its name.
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

// All of a point but its colour, error and track.
template <typename Reader>
void ReadPosition(Reader* reader, SparseModelFiles::FilePoint* point) {
  point->id = reader->template Read<uint64_t>();
  for (int i = 0; i < 3; ++i) {
    point->position(i) = reader->template Read<double>();
  }
}

}  // namespace tsar
