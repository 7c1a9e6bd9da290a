// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/tools/import/external_maps.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// Throws Error kUnsupported if tsar_refine has refined this workspace (its
// originals would not be those of the imported maps).
void RequireUnrefined(const std::filesystem::path& root);

// Throws Error kUnsupported for a depth or normal map that no import wrote.
void RequireNoForeignMaps(const std::filesystem::path& root,
                          const std::string& image_name,
                          MapType type);

// Throws Error kIo if a folder stands under the name of any file that the
// import of an image writes, keeps or removes: it would fail halfway.
void RequireNoFolders(const std::filesystem::path& root,
                      const std::string& image_name,
                      MapType type);

// Writes the maps of an image. Former maps of the same name and their cost map
// are kept in stereo/tsar_import/former unless an import wrote them, by the
// rules in originals.h. Each file is complete at any time, and UndoImport always
// works. Throws Error kIo.
void WriteImported(const std::filesystem::path& root,
                   const std::string& image_name,
                   MapType type,
                   const ImportedMaps& maps);

// Restores the former maps and removes imported ones and stereo/tsar_import. No
// files of other programs are removed, neither former maps nor those in their
// place, by the rules of Restore() in restore.h. num_restored of the result are
// undone imports. Can be called again after an interruption. The caller holds
// the WorkspaceLock. Throws Error: kNotFound (nothing was imported),
// kUnsupported (see RequireUnrefined()), kIo.
RestoreResult UndoImport(const std::filesystem::path& root);

}  // namespace tsar
