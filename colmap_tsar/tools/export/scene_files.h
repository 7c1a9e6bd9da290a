// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/workspace.h"

#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace tsar {

// A 4 x 4 matrix as a list of rows.
nlohmann::ordered_json MatrixJson(const Eigen::Matrix4d& matrix);

// The transform from world to camera: x right, y down, z forward.
Eigen::Matrix4d WorldToCamera(const Camera& camera);
// The inverse transform, whose translation is the camera's center.
Eigen::Matrix4d CameraToWorld(const Camera& camera);
// CameraToWorld() for OpenGL's camera frame: x right, y up, z backward.
Eigen::Matrix4d OpenGlCameraToWorld(const Camera& camera);

// A camera as "model" (PINHOLE), "width", "height", "fx", "fy", "cx" and "cy".
nlohmann::ordered_json IntrinsicsJson(const Camera& camera);

// Functions for training folders, which hold all images under their names.

// Throws Error kUnsupported if the name of an image is not UTF-8, as in JSON.
void RequireUtf8Names(const Workspace& workspace);

// Copies an image to "images/NAME", which it returns. Errors as CheckPhotoFile.
std::string CopyPhoto(const Workspace& workspace,
                      int image,
                      const ContainedPath& folder);

// The stem of each image's name, which identifies it in a format: "left/b" for
// "left/b.png". Throws Error kUnsupported if a name has no dot or two stems are
// equal, such as those of a.jpg and a.png.
std::vector<std::string> UniqueStems(const Workspace& workspace);

// Copies the files of cameras, images and points that were read (binary if all
// three exist, otherwise text) to a folder.
void CopySparseModel(const Workspace& workspace, const ContainedPath& folder);

}  // namespace tsar
