// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/import/prior_maps.h"
#include "colmap_tsar/store/restore.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// stereo/tsar_import: the maps that imports have replaced, and a record of what
// they wrote. Apart from stereo/tsar, since to tsar_refine imported maps are
// originals as good as COLMAP's.
ContainedPath GetImportFolder(const std::filesystem::path& root);

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
  int num_images = 0;  // Images and types whose import was undone.
  // As in RestoreResult, by the paths of depth maps.
  std::vector<std::filesystem::path> kept;
  std::vector<std::filesystem::path> conflicts;
  std::vector<std::filesystem::path> superseded;
};

// Puts the former maps back and removes imported ones and stereo/tsar_import.
// Nothing that somebody else wrote is removed, neither former maps nor what
// stands in their place; see Restore() in restore.h, whose rules are these. Can
// be called again after an interruption. The caller holds the WorkspaceLock.
// Throws Error: kNotFound (nothing was imported), kUnsupported (see
// RequireUnrefined), kCorrupt (a record is broken), kIo.
UndoResult UndoImport(const std::filesystem::path& root,
                      RestoreConflicts conflicts = RestoreConflicts::kReport);

}  // namespace tsar
