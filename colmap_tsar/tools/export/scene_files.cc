// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/export/scene_files.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/photo.h"

#include <unordered_map>

namespace tsar {
namespace {

Error Refused(const Workspace& workspace, const std::string& what) {
  return Error::File(ErrorCode::kUnsupported,
                     (workspace.Root() / "sparse").string(),
                     what,
                     "rename images and make the workspace again, or give "
                     "another " +
                         OptionName("format"));
}

}  // namespace

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
  return {{"model", "PINHOLE"},
          {"width", camera.width},
          {"height", camera.height},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy}};
}

void RequireUtf8Names(const Workspace& workspace) {
  for (const SparseModel::ModelImage& image : workspace.Model().images) {
    try {
      nlohmann::json(image.name).dump();
    } catch (const nlohmann::json::type_error&) {
      throw Refused(workspace,
                    "the name of the image " + image.name + " is not UTF-8");
    }
  }
}

std::string CopyPhoto(const Workspace& workspace,
                      int image,
                      const ContainedPath& folder) {
  const std::string path = "images/" + workspace.Model().images.at(image).name;
  CheckPhotoFile(workspace.ImagePath(image));
  CreateFolders((folder / path).Parent());
  CopyFile(workspace.ImagePath(image), folder / path);
  return path;
}

std::vector<std::string> UniqueStems(const Workspace& workspace) {
  std::vector<std::string> stems;
  std::unordered_map<std::string, std::string> names;
  for (const SparseModel::ModelImage& image : workspace.Model().images) {
    const size_t dot = image.name.rfind('.');
    if (dot == std::string::npos || dot == 0) {
      throw Refused(workspace,
                    "the name of the image " + image.name +
                        " has no extension, which the format needs");
    }
    stems.push_back(image.name.substr(0, dot));
    const auto [other, is_new] = names.emplace(stems.back(), image.name);
    if (!is_new) {
      throw Refused(workspace,
                    "the images " + other->second + " and " + image.name +
                        " differ in their extensions alone, so that the "
                        "format would have one depth map for both");
    }
  }
  return stems;
}

void CopySparseModel(const Workspace& workspace, const ContainedPath& folder) {
  CreateFolders(folder);
  for (const std::filesystem::path& file :
       FindSparseModelFiles(workspace.Root() / "sparse")) {
    CopyFile(file, folder / file.filename());
  }
}

}  // namespace tsar
