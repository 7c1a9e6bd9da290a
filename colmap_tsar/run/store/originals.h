// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/file_id.h"
#include "colmap_tsar/run/store/record.h"

#include <array>
#include <filesystem>
#include <optional>

namespace tsar {

// Whose map it is that stands under the name of a map:
// 1. One that the image's record lists is this program's; its original is in
//    stereo/tsar/original.
// 2. Any other one is the user's or COLMAP's and counts as the original. One
//    that is kept of an earlier time is put aside (see Supersede), not removed.
// 3. Restoring renames the original back, but never over a map of rule 2.
enum class MapState {
  kMissing,   // There is no file.
  kOriginal,  // The file that is kept: a killed program has just kept it.
  kRefined,   // Rule 1.
  kForeign,   // Rule 2.
  kDamaged,   // No complete map. One that is kept is the original.
  kUnknown,   // A map without a record, although an original is kept.
};

struct OriginalMap {
  MapState state = MapState::kMissing;
  bool is_kept = false;  // A file is in stereo/tsar/original.
  // The original; empty where there is none: there is no map, or it is lost.
  std::filesystem::path path;
  // There is a refined map, and what is kept for it is gone or incomplete.
  bool is_lost = false;
};

// The originals of an image's maps, as they are at one instant.
struct OriginalMaps {
  OriginalMap depth;
  OriginalMap normal;
  // The sizes and times of the maps and of those that are kept. The originals
  // are elsewhere only if these have changed.
  using Files = std::array<std::optional<FileId>, 4>;
  Files files;
};

OriginalMaps::Files FindMapFiles(const MapPaths& paths);

// record: nothing without a valid one.
OriginalMaps InspectOriginals(const MapPaths& paths,
                              const std::optional<ImageRecord>& record);

// The originals by the image's record. Other programs may be refining the image
// meanwhile. Throws Error: kMismatch where an original is lost, or where
// nothing tells whose a map is; what ReadRecord throws.
OriginalMaps FindOriginals(const MapPaths& paths);

// Throws Error kMismatch where the files beside an image's maps show that they
// were refined, but stereo/tsar, which held their originals, is gone: refined
// maps are no originals.
void RequireNoStrayResults(const MapPaths& paths);

// Throws Error kCorrupt where something else than a file stands in the place of
// an original.
void RequireFileIfThere(const ContainedPath& kept);

// Moves a file that has to make room for another map to stereo/tsar/superseded,
// where this program never touches it again, and returns its new path; the
// caller tells the user. path: the file; map: its map in stereo, whose name it
// keeps, with a number appended where that is taken.
ContainedPath Supersede(const ContainedPath& path, const ContainedPath& map);

// Makes sure that a map's original is kept, which stays under its own name,
// too. One that was kept and is outdated is superseded, and the user warned.
void KeepOriginal(const OriginalMap& original,
                  const ContainedPath& current,
                  const ContainedPath& kept);

// Renames an original that is kept back, unless there is a foreign map: then it
// is superseded. So is what else stands in its place and is no refined map.
// Returns the path of what was superseded, if any.
std::optional<ContainedPath> PutOriginalBack(const OriginalMap& original,
                                             const ContainedPath& current,
                                             const ContainedPath& kept);

}  // namespace tsar
