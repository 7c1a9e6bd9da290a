// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/plane_view.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/companion_maps.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/run/store/result_files.h"

#include <algorithm>
#include <string>
#include <utility>

namespace tsar {

Workspace OpenWorkspaceWithPlanes(const std::filesystem::path& root,
                                  std::optional<MapType> type) {
  Workspace workspace(root, type.value_or(MapType::kGeometric));
  if (!type && FindPlaneViews(workspace).empty()) {
    Workspace photometric(root, MapType::kPhotometric);
    if (!FindPlaneViews(photometric).empty()) {
      workspace = std::move(photometric);
    }
  }
  WarnOfChangedResults(workspace, {"planes", "provenance"});
  return workspace;
}

std::vector<int> FindPlaneViews(const Workspace& workspace) {
  std::vector<int> images;
  const int num_images = static_cast<int>(workspace.Model().images.size());
  for (int image = 0; image < num_images; ++image) {
    if (Exists(workspace.Paths(image, workspace.Type()).planes)) {
      images.push_back(image);
    }
  }
  return images;
}

PlaneView ReadPlaneView(const Workspace& workspace, int image, int num_planes) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const SparseModel::ModelImage& model_image =
      workspace.Model().images.at(image);
  PlaneView view;
  view.image = image;
  view.depth = ReadDepthMap(paths.depth);
  RequireShape(paths.depth,
               {view.depth.Width(), view.depth.Height()},
               {model_image.camera.width, model_image.camera.height},
               "the image " + model_image.name,
               "refine the workspace again");
  view.camera =
      model_image.camera.Resized(view.depth.Width(), view.depth.Height());
  view.provenance = RequireSizeOf(view.depth,
                                  "the depth map",
                                  paths.provenance,
                                  ReadGrayPng(paths.provenance));
  view.planes = RequireSizeOf(
      view.depth, "the depth map", paths.planes, ReadGray16Png(paths.planes));
  const int largest = *std::ranges::max_element(view.planes);
  if (largest > num_planes) {
    throw Error::File(ErrorCode::kMismatch,
                      paths.planes.string(),
                      "names plane " + std::to_string(largest - 1) + " of " +
                          std::to_string(num_planes) +
                          ", so it is not of the same run as "
                          "stereo/tsar/planes.bin",
                      "refine the workspace again");
  }
  return view;
}

}  // namespace tsar
