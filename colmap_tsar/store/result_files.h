// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/workspace/map_paths.h"

#include <array>

namespace tsar {

// The folders of stereo in which a refinement leaves files of its own beside
// the depth and normal maps.
inline constexpr std::array<const char*, 4> kResultFolders = {
    "confidence_maps", "sigma_maps", "provenance_maps", "plane_maps"};

// These files of one image, there or not, also those of earlier versions. The
// pointers are into the argument.
std::array<const ContainedPath*, 5> ResultFiles(const MapPaths& paths);

// Removes them.
void RemoveResults(const MapPaths& paths);

}  // namespace tsar
