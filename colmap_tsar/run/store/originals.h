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

// The origin of a map file:
// 1. A file that the image's record lists is this program's; its original is in
//    stereo/tsar/original.
// 2. Any other file is the user's or COLMAP's and counts as the original. An
//    older kept original is then set aside (see Supersede), not removed.
// 3. Restoring renames the original back, but never over a map of rule 2.
enum class MapState {
  kMissing,   // There is no file.
  kOriginal,  // Also the kept file: a killed program had just kept it.
  kRefined,   // Rule 1.
  kForeign,   // Rule 2.
  kDamaged,   // Not a complete map. If one is kept, that is the original.
  kUnknown,   // A map without a record, although an original is kept.
};

struct OriginalMap {
  MapState state = MapState::kMissing;
  bool is_kept = false;  // A file is in stereo/tsar/original.
  // The original; empty where there is none: there is no map, or it is lost.
  std::filesystem::path path;
  // There is a refined map, but its kept original is missing or incomplete.
  bool is_lost = false;
};

// The originals of an image's maps at one instant.
struct OriginalMaps {
  OriginalMap depth;
  OriginalMap normal;
  // The sizes and times of the maps and of those that are kept. The originals
  // have moved only if these have changed.
  using Files = std::array<std::optional<FileId>, 4>;
  Files files;
};

OriginalMaps::Files FindMapFiles(const MapPaths& paths);

// record: nothing without a valid one.
OriginalMaps InspectOriginals(const MapPaths& paths,
                              const std::optional<ImageRecord>& record);

// The originals by the image's record. Other programs may be refining the image
// meanwhile. Throws Error: kMismatch if an original is lost, or the origin of a
// map is unknown; what ReadRecord throws.
OriginalMaps FindOriginals(const MapPaths& paths);

// Throws Error kMismatch where the files beside an image's maps show that they
// were refined, but stereo/tsar, which held their originals, is gone: refined
// maps are no originals.
void RequireNoStrayResults(const MapPaths& paths);

// Throws Error kCorrupt if the path of an original exists but is not a file.
void RequireFileIfThere(const ContainedPath& kept);

// Moves a file that has to make room for another map to stereo/tsar/superseded,
// where this program never touches it again, and returns its new path; the
// caller informs the user. path: the file; map: its map in stereo, whose name
// it keeps, with a number appended where that is taken.
ContainedPath Supersede(const ContainedPath& path, const ContainedPath& map);

// Makes sure that a map's original is kept; it also stays under its own name.
// An outdated kept one is superseded, with a warning.
void KeepOriginal(const OriginalMap& original,
                  const ContainedPath& current,
                  const ContainedPath& kept);

// Renames a kept original back, unless there is a foreign map: then the
// original is superseded. So is anything else in its place that is not a
// refined map. Returns the path of what was superseded, if any.
std::optional<ContainedPath> PutOriginalBack(const OriginalMap& original,
                                             const ContainedPath& current,
                                             const ContainedPath& kept);

}  // namespace tsar
