// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// What to do with an image where nothing tells whose the maps in place are,
// such as where one of depth and normals alone was written anew, or where an
// original was changed where it is kept.
enum class RestoreConflicts {
  kReport,    // Change nothing, and say so.
  kKeep,      // Leave what is there; the original stays where it is kept.
  kOriginal,  // Put the originals back wherever there are some, also in the
              // place of maps that another program made anew. What stands there
              // is superseded.
};

// Whether runs have left anything in stereo/tsar, or originals are kept there;
// not what was superseded.
bool HasRunState(const std::filesystem::path& root);

// "report", "keep" or "original"; Error kBadOption for others.
RestoreConflicts ParseRestoreConflicts(const std::string& text);

struct RestoreResult {
  int num_restored = 0;  // Images and types whose originals were put back.
  // Maps that another program made anew, or that were kept on demand, by the
  // paths of their depth maps. The originals are kept beside them.
  std::vector<std::filesystem::path> kept;
  // Conflicts that were reported alone.
  std::vector<std::filesystem::path> conflicts;
  // Refined maps of which an original is gone, and which stay.
  std::vector<std::filesystem::path> lost;
  // Where the maps are now that stood in the way of originals.
  std::vector<std::filesystem::path> superseded;
  // Output workspaces whose links to originals were made again.
  std::vector<std::filesystem::path> relinked;
};

// Puts the originals back under their names, whatever their type, and removes
// what this program wrote: confidence, provenance and plane maps and
// stereo/tsar. An original is never removed but by being put back; nor is what
// somebody else wrote in its place (see superseded.h). Depth and normals of an
// image always come from one source. What is kept of an image whose maps were
// left as they are stays in stereo/tsar.
//
// Can be called again after an interruption. The caller holds the
// WorkspaceLock. Throws Error: kNotFound (nothing to restore), kUnsupported (an
// output workspace, whose originals lie elsewhere), kIo (also where a folder
// cannot be listed: what is in it would be forgotten).
RestoreResult Restore(const std::filesystem::path& root,
                      RestoreConflicts conflicts = RestoreConflicts::kReport);

}  // namespace tsar
