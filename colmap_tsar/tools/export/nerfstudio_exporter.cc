// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/resize_nearest.h"
#include "colmap_tsar/io/ply.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/json_file.h"
#include "colmap_tsar/tools/export/image_exporter.h"
#include "colmap_tsar/tools/export/map_levels.h"
#include "colmap_tsar/tools/export/scene_files.h"
#include "colmap_tsar/tools/export/value_files.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace tsar {
namespace {

using Json = nlohmann::ordered_json;

constexpr float kLevelsPerUnit = 1000.f;
constexpr float kHalfOfLevels = 127.5f;  // Of a normal's element.
constexpr const char* kCloudName = "points.ply";

Image<Rgb> NormalColors(const Image<Vec3f>& normals) {
  const auto to_level = [](float value) {
    return static_cast<uint8_t>(std::lround(
        kHalfOfLevels + kHalfOfLevels * std::clamp(value, -1.f, 1.f)));
  };
  Image<Rgb> colors(normals.Width(), normals.Height());
  std::ranges::transform(normals, colors.begin(), [&](const Vec3f& n) {
    return Rgb{to_level(n.x), to_level(n.y), to_level(n.z)};
  });
  return colors;
}

class NerfstudioExporter : public ImageExporter {
 public:
  NerfstudioExporter(const Workspace& workspace,
                     const ContainedPath& folder,
                     const std::filesystem::path& cloud)
      : workspace_(workspace),
        folder_(folder),
        cloud_(cloud),
        images_with_maps_(FindImagesWithMaps(workspace)),
        has_masks_(HasAnyMask(workspace)) {
    RequireUtf8Names(workspace);
    if (!cloud.empty() && ReadPlyCloud(cloud, 1).num_points_read == 0) {
      throw Error::File(ErrorCode::kNotFound,
                        cloud.string(),
                        "has no points",
                        "give the cloud of tsar_fuse or stereo_fusion");
    }
  }

  Json DescribeMaps() const override {
    Json maps;
    maps["depth"] = {
        {"meaning",
         "z in the camera's frame, in units of the sparse model; 0: no depth"},
        {"stored", "float32"},
        {"scale", 1.0 / kLevelsPerUnit},
        {"offset", 0.0}};
    maps["normals"] = {
        {"meaning",
         "unit vector in the camera's frame, towards the camera; (0, 0, 0), "
         "which is stored as 128, 128, 128: none"},
        {"stored", "uint8, red green blue"},
        {"scale", 1.0 / kHalfOfLevels},
        {"offset", -1.0}};
    if (has_masks_) {
      maps["mask"] = {{"meaning", "0: masked, 255: not"}, {"stored", "uint8"}};
    }
    return maps;
  }

  ExportedImage Export(int image) const override {
    const SparseModel::ModelImage& model_image =
        workspace_.Model().images.at(image);
    const bool has_maps = std::ranges::binary_search(images_with_maps_, image);
    const int width = model_image.camera.width;
    const int height = model_image.camera.height;
    Image<float> depth = has_maps ? ReadImageDepth(workspace_, image)
                                  : Image<float>(width, height);
    const Image<Vec3f> normals = has_maps
                                     ? ReadImageNormal(workspace_, image, depth)
                                     : Image<Vec3f>(width, height);
    ExportedImage exported = Describe(depth);
    exported.files["photo"] = CopyPhoto(workspace_, image, folder_);
    const auto new_file = [&](const std::string& kind,
                              const std::string& path) {
      exported.files[kind] = path;
      return folder_ / path;
    };
    for (float& z : depth) {
      z *= kLevelsPerUnit;
    }
    WriteArray(new_file("depth", "depths/" + model_image.name + ".npy"), depth);
    WritePngFile(new_file("normals", "normals/" + model_image.name + ".png"),
                 ResizeNearest<Rgb>(NormalColors(normals), width, height));

    if (has_masks_) {
      WritePngFile(
          new_file("mask", "masks/" + model_image.name + ".png"),
          MaskLevels(image,
                     has_maps ? RasterSize{depth.Width(), depth.Height()}
                              : MapSizeOfOthers(model_image.camera)));
    }
    return exported;
  }

  void Finish(const std::vector<int>& images,
              const std::vector<ExportedImage>& exported) const override {
    Json json;
    json["camera_model"] = "OPENCV";
    // World coordinates are those of the sparse model.
    json["applied_transform"] = {
        {1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}};
    if (!cloud_.empty()) {
      CopyFile(cloud_, folder_ / kCloudName);
      json["ply_file_path"] = kCloudName;
    }
    json["frames"] = Json::array();
    for (size_t i = 0; i < images.size(); ++i) {
      const Camera& camera = workspace_.Model().images.at(images[i]).camera;
      Json frame;
      frame["file_path"] = exported[i].files.at("photo");
      frame["depth_file_path"] = exported[i].files.at("depth");
      frame["normal_file_path"] = exported[i].files.at("normals");
      if (has_masks_) {
        frame["mask_path"] = exported[i].files.at("mask");
      }
      frame["w"] = camera.width;
      frame["h"] = camera.height;
      frame["fl_x"] = camera.fx;
      frame["fl_y"] = camera.fy;
      frame["cx"] = camera.cx;
      frame["cy"] = camera.cy;
      frame["transform_matrix"] = MatrixJson(OpenGlCameraToWorld(camera));
      json["frames"].push_back(std::move(frame));
    }
    WriteOrderedJson(folder_ / "transforms.json", json);
  }

 private:
  static bool HasAnyMask(const Workspace& workspace) {
    bool has_any = false;
    for (size_t image = 0; image < workspace.Model().images.size(); ++image) {
      has_any |= workspace.HasMask(static_cast<int>(image));
    }
    return has_any;
  }

  // The mask at the photo's size, which all images need if one has a mask.
  Image<uint8_t> MaskLevels(int image, const RasterSize& maps) const {
    const Camera& camera = workspace_.Model().images.at(image).camera;
    Image<uint8_t> levels(camera.width, camera.height, 255);
    ClearMasked(workspace_.ReadMaskOfImage(image, maps), &levels);
    return levels;
  }

  // The size that maps of an image without maps would have, for its mask.
  RasterSize MapSizeOfOthers(const Camera& camera) const {
    for (const int image : images_with_maps_) {
      const Camera& other = workspace_.Model().images.at(image).camera;
      if (other.width == camera.width && other.height == camera.height) {
        const Image<float> depth = ReadImageDepth(workspace_, image);
        return {depth.Width(), depth.Height()};
      }
    }
    return {camera.width, camera.height};
  }

  const Workspace& workspace_;
  ContainedPath folder_;
  std::filesystem::path cloud_;
  std::vector<int> images_with_maps_;
  bool has_masks_;
};

}  // namespace

std::unique_ptr<ImageExporter> MakeNerfstudioExporter(
    const Workspace& workspace,
    const ContainedPath& folder,
    const std::filesystem::path& cloud) {
  return std::make_unique<NerfstudioExporter>(workspace, folder, cloud);
}

}  // namespace tsar
