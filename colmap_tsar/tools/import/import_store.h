// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/tools/import/external_maps.h"

#include <filesystem>
#include <string>

namespace tsar {

// Throws Error kUnsupported where tsar_refine has worked on this workspace
// (what it keeps are the originals of other maps than those that an import
// would leave), or where the workspace is the output of tsar_refine.
void RequireUnrefined(const std::filesystem::path& root);

// Throws Error kUnsupported where the image has a depth or normal map of this
// type that an import has not written.
void RequireNoForeignMaps(const std::filesystem::path& root,
                          const std::string& image_name,
                          MapType type);

// Writes the maps of an image. Former maps of the same name, and a cost map
// that belonged to them, are kept in stereo/tsar_import unless an import has
// written them. At every instant each file is complete, and UndoImport finds
// what it needs. Throws Error kIo.
void WriteImported(const std::filesystem::path& root,
                   const std::string& image_name,
                   MapType type,
                   const ImportedMaps& maps);

}  // namespace tsar
