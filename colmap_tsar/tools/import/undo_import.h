// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/restore.h"

#include <filesystem>
#include <vector>

namespace tsar {

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
// RequireUnrefined() in import_store.h), kCorrupt (a record is broken), kIo.
UndoResult UndoImport(const std::filesystem::path& root,
                      RestoreConflicts conflicts = RestoreConflicts::kReport);

}  // namespace tsar
