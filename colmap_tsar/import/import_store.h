// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/import/prior_maps.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <filesystem>
#include <string>

namespace tsar {

// stereo/tsar_import: the maps that imports have replaced, and a record of what
// they wrote. Apart from stereo/tsar, since to tsar_refine imported maps are
// originals as good as COLMAP's.
std::filesystem::path GetImportFolder(const std::filesystem::path& root);

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

struct UndoResult {
  int num_images = 0;  // Images and types that had been imported.
  // Of these, those with maps that another program wrote since: left as they
  // are, and the former ones dropped.
  int num_newer = 0;
};

// Puts the former maps back, removes imported ones and stereo/tsar_import. Can
// be called again after an interruption. The caller holds the WorkspaceLock.
// Throws Error: kNotFound (nothing was imported), kUnsupported (see
// RequireUnrefined), kCorrupt (a record is broken), kIo.
UndoResult UndoImport(const std::filesystem::path& root);

}  // namespace tsar
