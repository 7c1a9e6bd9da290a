// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/export/export_manifest.h"

#include "colmap_tsar/base/path.h"
#include "colmap_tsar/export/camera_json.h"

#include <algorithm>
#include <string>
#include <utility>

namespace tsar {
namespace {

using Json = nlohmann::ordered_json;

Json Conventions() {
  Json json;
  json["units"] = "lengths are in units of the sparse model";
  json["camera_frame"] = "x right, y down, z forward";
  json["poses"] =
      "4 x 4, row by row: world_to_camera takes points of the sparse model to "
      "the camera's frame";
  json["pixels"] =
      "column x and row y count from 0; depth z there is the point z * ((x - "
      "cx) / fx, (y - cy) / fy, 1) of the camera's frame, as for stereo_fusion";
  json["half_pixel"] =
      "cx and cy are the sparse model's, scaled: in it (0.5, 0.5) is the "
      "centre "
      "of the top left pixel; what is projected for the photos, as by "
      "trainers, "
      "takes x + 0.5 and y + 0.5";
  json["values"] = "scale * stored + offset";
  return json;
}

Json ImageJson(const Workspace& workspace,
               int image,
               const ExportedImage& exported) {
  const SparseModel::ModelImage& model_image =
      workspace.Model().images.at(static_cast<size_t>(image));
  Json json;
  json["name"] = model_image.name;
  json["camera"] = IntrinsicsJson(
      model_image.camera.Resized(exported.width, exported.height));
  json["world_to_camera"] = MatrixJson(WorldToCamera(model_image.camera));
  json["camera_to_world"] = MatrixJson(CameraToWorld(model_image.camera));
  json["refined"] = Exists(workspace.ProvenancePath(image, workspace.Type()));
  json["num_depths"] = exported.depth.num_depths;
  json["num_out_of_range"] = exported.num_out_of_range;
  json["files"] = exported.files;
  return json;
}

}  // namespace

Json MakeExportManifest(const Workspace& workspace,
                        ExportFormat format,
                        const Json& maps,
                        const std::vector<int>& images,
                        const std::vector<ExportedImage>& exported) {
  Json json;
  json["format"] = "tsar_export";
  json["version"] = 1;
  json["program"] = std::string("colmap_tsar ") + TSAR_VERSION;
  json["export_format"] = ToString(format);
  json["map_type"] = ToString(workspace.Type());
  json["conventions"] = Conventions();
  json["maps"] = maps;
  json["images"] = Json::array();
  for (size_t i = 0; i < images.size(); ++i) {
    json["images"].push_back(ImageJson(workspace, images[i], exported[i]));
  }
  json["images_left_out"] = Json::array();
  const int num_images = static_cast<int>(workspace.Model().images.size());
  for (int image = 0; image < num_images; ++image) {
    if (!std::binary_search(images.begin(), images.end(), image)) {
      json["images_left_out"].push_back(
          workspace.Model().images[static_cast<size_t>(image)].name);
    }
  }
  return json;
}

}  // namespace tsar
