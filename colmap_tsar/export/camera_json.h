// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace tsar {

// 4 x 4, a list for each row.
nlohmann::ordered_json MatrixJson(const Eigen::Matrix4d& matrix);

// World to camera: x right, y down, z forward.
Eigen::Matrix4d WorldToCamera(const Camera& camera);
// Its inverse, in which the translation is the camera's centre.
Eigen::Matrix4d CameraToWorld(const Camera& camera);
// The same for a camera's frame as OpenGL has it: x right, y up, z backward.
Eigen::Matrix4d OpenGlCameraToWorld(const Camera& camera);

// "model" (PINHOLE), "width", "height", "fx", "fy", "cx" and "cy".
nlohmann::ordered_json IntrinsicsJson(const Camera& camera);

}  // namespace tsar
