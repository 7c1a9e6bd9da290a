// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/export/camera_json.h"

namespace tsar {

nlohmann::ordered_json MatrixJson(const Eigen::Matrix4d& matrix) {
  auto rows = nlohmann::ordered_json::array();
  for (int row = 0; row < matrix.rows(); ++row) {
    rows.push_back(
        {matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
  }
  return rows;
}

Eigen::Matrix4d WorldToCamera(const Camera& camera) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = camera.rotation;
  matrix.topRightCorner<3, 1>() = camera.translation;
  return matrix;
}

Eigen::Matrix4d CameraToWorld(const Camera& camera) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = camera.rotation.transpose();
  matrix.topRightCorner<3, 1>() = camera.Center();
  return matrix;
}

Eigen::Matrix4d OpenGlCameraToWorld(const Camera& camera) {
  return CameraToWorld(camera) *
         Eigen::Vector4d(1.0, -1.0, -1.0, 1.0).asDiagonal();
}

nlohmann::ordered_json IntrinsicsJson(const Camera& camera) {
  nlohmann::ordered_json json;
  json["model"] = "PINHOLE";
  json["width"] = camera.width;
  json["height"] = camera.height;
  json["fx"] = camera.fx;
  json["fy"] = camera.fy;
  json["cx"] = camera.cx;
  json["cy"] = camera.cy;
  return json;
}

}  // namespace tsar
