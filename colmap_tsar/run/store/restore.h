// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// The treatment of an image whose maps in place are of unknown origin, for
// example where only one of depth and normals was written anew, or whose stored
// original was changed.
enum class RestoreConflicts {
  kReport,    // Change nothing, and report it.
  kKeep,      // Keep the maps in place; the original stays stored.
  kOriginal,  // Put all stored originals back, also in the
              // place of maps that another program made anew, which are
              // superseded.
};

// "report", "keep" or "original"; Error kBadOption for others.
RestoreConflicts ParseRestoreConflicts(const std::string& text);

struct RestoreResult {
  int num_restored = 0;  // Images and types whose originals were put back.
  // Depth map paths of images whose maps another program made anew, or that
  // were kept on demand. Their originals are kept, too.
  std::vector<std::filesystem::path> kept;
  // Conflicts that were only reported.
  std::vector<std::filesystem::path> conflicts;
  // Refined maps without an original, which stay.
  std::vector<std::filesystem::path> lost;
  // The new locations of maps that originals replaced.
  std::vector<std::filesystem::path> superseded;
  // Output workspaces whose links to originals were renewed.
  std::vector<std::filesystem::path> relinked;
};

// Puts the originals of all types back under their names, and removes the files
// of this program: confidence, provenance and plane maps and stereo/tsar. An
// original is only removed by being put back; maps that another program wrote
// in its place are never removed (see Supersede). Depth and normals of an
// image always come from one source. The stored originals of an image whose
// maps were kept stay in stereo/tsar.
//
// Can be called again after an interruption. The caller holds the
// WorkspaceLock. Throws Error: kNotFound (nothing to restore), kUnsupported (an
// output workspace, whose originals lie elsewhere), kIo (also where a folder
// cannot be listed: its originals would be lost).
RestoreResult Restore(const std::filesystem::path& root,
                      RestoreConflicts conflicts = RestoreConflicts::kReport);

}  // namespace tsar
