// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/image_maps.h"

#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/gray_png.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/io/sigma_map.h"

#include <filesystem>
#include <string>
#include <utility>

namespace tsar {
namespace {

// Reads the map in a file; empty if there is no such file.
template <typename Read>
auto ReadIfThere(const Image<float>& depth,
                 const std::filesystem::path& path,
                 Read read) {
  return Exists(path) ? RequireSizeOf(depth, "the depth map", path, read(path))
                      : decltype(read(path))();
}

Image<uint8_t> MaskOf(const Workspace& workspace,
                      int image,
                      const Image<float>& depth) {
  return workspace.ReadMask(image, {depth.Width(), depth.Height()});
}

// Reads a depth map including masked pixels.
Image<float> ReadWholeDepth(const Workspace& workspace, int image) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const SparseModel::ModelImage& model_image =
      workspace.Model().images.at(static_cast<size_t>(image));
  Image<float> depth = ReadDepthMap(paths.depth);
  RequireShape(paths.depth,
               {depth.Width(), depth.Height()},
               {model_image.camera.width, model_image.camera.height},
               "the image " + model_image.name,
               "run patch_match_stereo again for this image");
  return depth;
}

// Reads a normal map including masked pixels.
Image<Vec3f> ReadWholeNormal(const Workspace& workspace,
                             int image,
                             const Image<float>& depth) {
  const ContainedPath path = workspace.Paths(image, workspace.Type()).normal;
  return RequireSizeOf(depth, "the depth map", path, ReadNormalMap(path));
}

}  // namespace

std::vector<int> FindImagesWithMaps(const Workspace& workspace) {
  std::vector<int> images;
  const int num_images = static_cast<int>(workspace.Model().images.size());
  for (int image = 0; image < num_images; ++image) {
    const MapPaths paths = workspace.Paths(image, workspace.Type());
    if (Exists(paths.depth) && Exists(paths.normal)) {
      images.push_back(image);
    }
  }
  return images;
}

std::vector<int> FindRefinedImages(const Workspace& workspace) {
  const MapType type = workspace.Type();
  std::vector<int> refined;
  const int num_images = static_cast<int>(workspace.Model().images.size());
  for (int image = 0; image < num_images; ++image) {
    if (workspace.HasMaps(image, type) &&
        Exists(workspace.ProvenancePath(image, type))) {
      refined.push_back(image);
    }
  }
  return refined;
}

Workspace OpenWorkspaceWithMaps(const std::filesystem::path& root,
                                std::optional<MapType> type) {
  Workspace workspace(root, type.value_or(MapType::kGeometric));
  if (!type && FindRefinedImages(workspace).empty()) {
    Workspace photometric(root, MapType::kPhotometric);
    if (!FindRefinedImages(photometric).empty() ||
        (FindImagesWithMaps(workspace).empty() &&
         !FindImagesWithMaps(photometric).empty())) {
      return photometric;
    }
  }
  return workspace;
}

Image<float> ReadImageDepth(const Workspace& workspace, int image) {
  Image<float> depth = ReadWholeDepth(workspace, image);
  ClearMasked(MaskOf(workspace, image, depth), &depth);
  return depth;
}

Image<Vec3f> ReadImageNormal(const Workspace& workspace,
                             int image,
                             const Image<float>& depth) {
  Image<Vec3f> normal = ReadWholeNormal(workspace, image, depth);
  ClearMasked(MaskOf(workspace, image, depth), &normal);
  return normal;
}

ImageMaps ReadImageMaps(const Workspace& workspace, int image) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  ImageMaps maps;
  maps.depth = ReadWholeDepth(workspace, image);
  maps.normal = ReadWholeNormal(workspace, image, maps.depth);
  maps.confidence = ReadIfThere(maps.depth, paths.confidence, &ReadGrayPng);
  maps.sigma = ReadIfThere(maps.depth, paths.sigma, &ReadSigmaMap);
  maps.provenance = ReadIfThere(maps.depth, paths.provenance, &ReadGrayPng);
  maps.planes = ReadIfThere(maps.depth, paths.planes, &ReadGray16Png);
  const Image<uint8_t> mask = MaskOf(workspace, image, maps.depth);
  ClearMasked(mask, &maps.depth);
  ClearMasked(mask, &maps.normal);
  ClearMasked(mask, &maps.confidence);
  ClearMasked(mask, &maps.sigma);
  ClearMasked(mask, &maps.provenance);
  ClearMasked(mask, &maps.planes);
  return maps;
}

ImageMaps ReadOriginalImageMaps(const Workspace& workspace, int image) {
  DepthNormal original = workspace.ReadOriginalMaps(image, workspace.Type());
  ImageMaps maps;
  maps.depth = std::move(original.depth);
  maps.normal = std::move(original.normal);
  const Image<uint8_t> mask = MaskOf(workspace, image, maps.depth);
  ClearMasked(mask, &maps.depth);
  ClearMasked(mask, &maps.normal);
  return maps;
}

}  // namespace tsar
