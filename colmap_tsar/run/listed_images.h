// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/image_catalog.h"
#include "colmap_tsar/run/store/workspace.h"

#include <filesystem>
#include <vector>

namespace tsar {

// For each of Problems(), whether a file of image names lists its reference,
// see ReadImageList; the file may list an image several times. All are listed
// where the path is empty. Throws Error: what ReadImageList throws, and
// kMismatch where an image has no sources in patch-match.cfg.
std::vector<bool> FindListedImages(const Workspace& workspace,
                                   const std::filesystem::path& list);

// Has the catalog refine the listed images alone; all where the path is
// empty. shares_planes: whether all images share the planes of the scene. Then
// throws Error, kUnsupported, where an image that is not listed was refined
// from other inputs or with other options: those planes are found anew.
void RefineListedImages(const Workspace& workspace,
                        const std::filesystem::path& list,
                        bool shares_planes,
                        ImageCatalog* catalog);

}  // namespace tsar
