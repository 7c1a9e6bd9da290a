// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <vector>

namespace tsar {

struct RestoreResult {
  int num_restored = 0;  // Images and types whose originals were put back.
  // Maps that were written in the place of refined ones; they stay.
  std::vector<std::filesystem::path> kept;
  // Refined maps without an original; they stay.
  std::vector<std::filesystem::path> lost;
  // The new paths of what was moved out of the way: the originals of maps that
  // stay, and files in an original's place that were not refined maps.
  std::vector<std::filesystem::path> superseded;
};

// Puts the originals of all types back under their names, and removes the files
// of this program: confidence, sigma, provenance and plane maps and
// stereo/tsar. No map but a refined one is removed, see originals.h.
//
// Can be called again after an interruption. The caller holds the
// WorkspaceLock. Throws Error: kNotFound (nothing to restore), kCorrupt (the
// path of an original is not a file), kIo (also where a folder cannot be
// listed: its originals would be lost).
RestoreResult Restore(const std::filesystem::path& root);

}  // namespace tsar
