// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/store/workspace.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <filesystem>
#include <optional>

namespace tsar {

// The workspace whose planes are asked for. type: of the maps; if not given:
// geometric, or photometric where only those have planes. Errors as Workspace.
Workspace OpenWorkspaceWithPlanes(const std::filesystem::path& root,
                                  std::optional<MapType> type);

}  // namespace tsar
