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

// 4 x 4, a list for each row.
nlohmann::ordered_json MatrixJson(const Eigen::Matrix4d& matrix);

// World to camera: x right, y down, z forward.
Eigen::Matrix4d WorldToCamera(const Camera& camera);
// Its inverse, in which the translation is the camera's center.
Eigen::Matrix4d CameraToWorld(const Camera& camera);
// The same for a camera's frame as OpenGL has it: x right, y up, z backward.
Eigen::Matrix4d OpenGlCameraToWorld(const Camera& camera);

// "model" (PINHOLE), "width", "height", "fx", "fy", "cx" and "cy".
nlohmann::ordered_json IntrinsicsJson(const Camera& camera);

// What the folders for trainers have in common: they hold all images of the
// sparse model, under its names.

// Throws Error kUnsupported where the name of an image is not UTF-8: JSON could
// not name its files.
void RequireUtf8Names(const Workspace& workspace);

// Copies an image to images/NAME in the folder, and returns "images/NAME".
// Throws what CheckPhotoFile throws.
std::string CopyPhoto(const Workspace& workspace,
                      int image,
                      const ContainedPath& folder);

// The name of each image without what follows its last dot, by which a format
// knows it: "left/b" for "left/b.png". Throws Error: kUnsupported where a name
// has no dot, or two have the same, such as a.jpg and a.png.
std::vector<std::string> UniqueStems(const Workspace& workspace);

// Copies the files of cameras, images and points that were read (binary where
// all three are there, otherwise text) into a folder.
void CopySparseModel(const Workspace& workspace, const ContainedPath& folder);

}  // namespace tsar
