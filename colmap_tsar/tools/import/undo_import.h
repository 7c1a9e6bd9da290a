// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/restore.h"

#include <filesystem>
#include <vector>

namespace tsar {

struct UndoResult {
  int num_images = 0;  // Undone imports, counted by image and type.
  // Paths of depth maps, as in RestoreResult.
  std::vector<std::filesystem::path> kept;
  std::vector<std::filesystem::path> conflicts;
  std::vector<std::filesystem::path> superseded;
};

// Restores the former maps and removes imported ones and stereo/tsar_import. No
// files of other programs are removed, neither former maps nor those in their
// place, by the rules of Restore() in restore.h. Can be called again after an
// interruption. The caller holds the WorkspaceLock. Throws Error: kNotFound
// (nothing was imported), kUnsupported (see RequireUnrefined() in
// import_store.h), kCorrupt (a record is broken), kIo.
UndoResult UndoImport(const std::filesystem::path& root,
                      RestoreConflicts conflicts = RestoreConflicts::kReport);

}  // namespace tsar
