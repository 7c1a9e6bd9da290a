// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/open_workspace_with_planes.h"

#include "colmap_tsar/plane_export/plane_view.h"

namespace tsar {

Workspace OpenWorkspaceWithPlanes(const std::filesystem::path& root,
                                  std::optional<MapType> type) {
  Workspace workspace(root, type.value_or(MapType::kGeometric));
  if (!type && FindPlaneViews(workspace).empty()) {
    Workspace photometric(root, MapType::kPhotometric);
    if (!FindPlaneViews(photometric).empty()) {
      return photometric;
    }
  }
  return workspace;
}

}  // namespace tsar
