// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>

namespace tsar {

struct RestoreResult {
  int num_restored = 0;  // Images and types whose originals were put back.
  // Maps that COLMAP wrote anew after the refinement: left as they are, and the
  // older originals dropped.
  int num_newer = 0;
};

// Puts all originals back under their names, whatever their type, and removes
// what this program wrote: confidence maps, provenance maps and stereo/tsar.
// Can be called again after an interruption. The caller holds the
// WorkspaceLock. Throws Error: kNotFound (nothing to restore), kUnsupported (an
// output workspace, whose originals lie elsewhere), kIo.
RestoreResult Restore(const std::filesystem::path& root);

}  // namespace tsar
