// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/workspace.h"

#include <array>
#include <string>
#include <vector>

namespace tsar {

// The folders of stereo in which refinement writes files beside the depth and
// normal maps.
inline constexpr std::array<const char*, 4> kResultFolders = {
    "confidence_maps", "sigma_maps", "provenance_maps", "plane_maps"};

struct ResultFile {
  const char* name;  // The name of its content.
  const ContainedPath* path;
};

// The files of one image, existing or not. Paths point into the argument.
std::array<ResultFile, 4> ResultFiles(const MapPaths& paths);

// Removes the result files.
void RemoveResults(const MapPaths& paths);

// For programs that read the maps of the workspace's type and the files that
// refinement writes beside them: gives one warning each about files that are
// missing or differ from their images' records, about depth or normal maps
// without the other, and about images that are not refined, or with other
// options, beside others that are. names: "depth", "normal" and those of
// ResultFiles(), whose files are read; empty: all.
// Throws what ReadRecord and HashFile throw, except for corrupt records, which
// are another warning.
void WarnOfChangedResults(const Workspace& workspace,
                          const std::vector<std::string>& names = {});

}  // namespace tsar
