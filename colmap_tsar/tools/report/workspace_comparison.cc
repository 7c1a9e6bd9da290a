// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/workspace_comparison.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/companion_maps.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace tsar {

std::vector<int> PickEvenly(const std::vector<int>& values, int count) {
  const size_t num_picked =
      std::min(values.size(), static_cast<size_t>(std::max(0, count)));
  std::vector<int> picked;
  for (size_t i = 0; i < num_picked; ++i) {
    picked.push_back(values[i * values.size() / num_picked]);
  }
  return picked;
}

ComparisonRow ReadComparisonRow(const Workspace& workspace, int image) {
  const MapType type = workspace.Type();
  ComparisonRow row;
  row.name = workspace.Model().images[image].name;
  DepthNormal original = workspace.ReadOriginalMaps(image, type);
  row.before = std::move(original.depth);
  row.normals_before = std::move(original.normal);
  const MapPaths paths = workspace.Paths(image, type);
  row.after = RequireSizeOf(
      row.before, "the map was before", paths.depth, ReadDepthMap(paths.depth));
  row.normals_after = RequireSizeOf(row.before,
                                    "the map was before",
                                    paths.normal,
                                    ReadNormalMap(paths.normal));
  row.provenance = RequireSizeOf(row.before,
                                 "the map was before",
                                 paths.provenance,
                                 ReadGrayPng(paths.provenance));
  row.image =
      workspace.ReadImage(image, row.before.Width(), row.before.Height());
  return row;
}

}  // namespace tsar
