// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/stereo/stereo_passes.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/stereo/stereo_claim.h"
#include "colmap_tsar/workspace/map_io.h"

#include <filesystem>
#include <string>

namespace tsar {

namespace fs = std::filesystem;

bool StereoMapFiles::Exist() const {
  return fs::exists(depth) && fs::exists(normal) &&
         (!cost || fs::exists(*cost));
}

void WriteStereoMaps(const StereoMapFiles& files, const StereoMaps& maps) {
  CreateFolders(files.depth.Parent());
  CreateFolders(files.normal.Parent());
  if (files.cost) {
    CreateFolders(files.cost->Parent());
    PlanarMap costs;
    costs.width = maps.depth.Width();
    costs.height = maps.depth.Height();
    costs.channels = 2;
    costs.values.assign(maps.min_cost.begin(), maps.min_cost.end());
    costs.values.insert(
        costs.values.end(), maps.second_cost.begin(), maps.second_cost.end());
    WritePlanarMap(*files.cost, costs);
  }
  WriteNormalMap(files.normal, maps.normal);
  WriteDepthMap(files.depth, maps.depth);
}

StereoPasses::StereoPasses(const Workspace& workspace,
                           const StereoOptions& options)
    : workspace_(workspace),
      num_geometric_(options.geom_consistency ? options.num_geometric_passes
                                              : 0) {}

StereoMapFiles StereoPasses::Files(int pass, int image) const {
  if (pass > 0 && pass < num_geometric_) {
    const std::string key =
        workspace_.Model().images[static_cast<size_t>(image)].name;
    const ContainedPath folder =
        GetStereoFolder(workspace_) / ("pass_" + std::to_string(pass));
    return {folder / "depth" / (key + ".bin"),
            folder / "normal" / (key + ".bin"),
            std::nullopt};
  }
  const MapPaths paths = workspace_.Paths(
      image, pass == 0 ? MapType::kPhotometric : MapType::kGeometric);
  return {paths.depth, paths.normal, paths.cost};
}

bool StereoPasses::IsDone(int image) const {
  return Files(0, image).Exist() && Files(num_geometric_, image).Exist();
}

void StereoPasses::RemoveFilesBetween() const {
  for (int pass = 1; pass < num_geometric_; ++pass) {
    RemoveTree(GetStereoFolder(workspace_) / ("pass_" + std::to_string(pass)));
  }
}

}  // namespace tsar
