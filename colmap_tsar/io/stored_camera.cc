// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/stored_camera.h"

#include "colmap_tsar/io/float_map.h"

#include <cmath>
#include <sstream>

#include <Eigen/LU>

namespace tsar {
namespace {

Error CorruptCamera(const std::string& name, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     name,
                     what,
                     "make the file again, or take it away to go without it");
}

// Reads the matrix that follows a word.
template <typename Matrix>
Matrix ReadMatrix(std::istringstream* text,
                  const std::string& word,
                  const std::string& name) {
  std::string read;
  *text >> read;
  Matrix matrix;
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int column = 0; column < matrix.cols(); ++column) {
      *text >> matrix(row, column);
    }
  }
  if (!*text || read != word) {
    throw CorruptCamera(name,
                        "not a camera: it has no \"" + word + "\" with " +
                            std::to_string(matrix.size()) + " numbers");
  }
  return matrix;
}

}  // namespace

void SetCalibration(const Eigen::Matrix3d& k, StoredCamera* camera) {
  camera->fx = k(0, 0);
  camera->fy = k(1, 1);
  camera->cx = k(0, 2);
  camera->cy = k(1, 2);
  if (!k.allFinite() || !camera->rotation.allFinite() ||
      !camera->center.allFinite()) {
    throw CorruptCamera(camera->file,
                        "the camera has a value that is no number");
  }
  if (camera->fx <= 0.0 || camera->fy <= 0.0) {
    throw CorruptCamera(camera->file,
                        "the camera has a focal length that is not positive");
  }
  const double deviation = (camera->rotation * camera->rotation.transpose() -
                            Eigen::Matrix3d::Identity())
                               .cwiseAbs()
                               .maxCoeff();
  if (deviation > 1e-3 || camera->rotation.determinant() < 0.0) {
    throw CorruptCamera(camera->file, "the camera's rotation is none");
  }
}

StoredCamera ParseCamFile(std::span<const uint8_t> bytes,
                          const std::string& name) {
  std::istringstream text(std::string(bytes.begin(), bytes.end()));
  const auto pose = ReadMatrix<Eigen::Matrix4d>(&text, "extrinsic", name);
  const auto k = ReadMatrix<Eigen::Matrix3d>(&text, "intrinsic", name);
  StoredCamera camera;
  camera.file = name;
  camera.rotation = pose.topLeftCorner<3, 3>();
  camera.center = -camera.rotation.transpose() * pose.topRightCorner<3, 1>();
  SetCalibration(k, &camera);
  return camera;
}

}  // namespace tsar
