// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/io/written_map.h"
#include "colmap_tsar/run/store/record.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace tsar {

// The state of the file under the name of a map that this program has replaced,
// and whose original it keeps.
enum class MapState {
  kMissing,   // There is no file.
  kWritten,   // The map that this program wrote.
  kOriginal,  // The same bytes as the original.
  kEdited,    // This program's map, edited: masked or thresholded.
  kDamaged,   // Not a complete map.
  kNew,       // A complete map of other values and of another time than what
              // this program wrote: another one wrote it.
  kUnknown,   // Another map, of unknown origin.
};

// original: may be missing. written: the maps that this program may have
// written under this name; null without a record.
MapState InspectMap(const std::filesystem::path& current,
                    const std::filesystem::path& original,
                    const std::vector<WrittenMap>* written,
                    Scrutiny scrutiny = Scrutiny::kContent);

// Whether a map whose original is not stored is a refined one. record: null
// without one. A map with the original's bytes is the original, even if this
// program wrote the same bytes: an interrupted restoration has put it there.
bool IsRefined(const std::filesystem::path& current,
               const MapRecord* record,
               Scrutiny scrutiny = Scrutiny::kContent);

// Whether the file at `stored`, kept while the map in place has this state
// (nothing: none is kept), is not the recorded original or, without a record,
// not even a complete map. A map that is itself the stored one may be newer
// than the record: a killed run has just kept it.
bool IsStoredChanged(std::optional<MapState> state,
                     const std::filesystem::path& stored,
                     const std::optional<WrittenMap>& original,
                     Scrutiny scrutiny = Scrutiny::kContent);

// The program that made the maps of an image, since depth and normals always
// come from one source.
enum class MapOwner {
  kThisProgram,   // The originals are the stored ones.
  kOtherProgram,  // patch_match_stereo made both anew.
  kUndecided,
};

// The owner by the states of the maps whose originals are stored. Where one of
// the two is not, because a program was killed in between, the other decides.
MapOwner FindOwner(std::optional<MapState> depth,
                   std::optional<MapState> normal);

// The location of the map that COLMAP wrote.
enum class OriginalState {
  kMissing,  // There is no map.
  kInPlace,  // Under its own name; nothing is stored.
  kStored,   // In stereo/tsar/original; the map in its place is this program's.
  kReplaced,  // Under its own name: COLMAP wrote both maps of the image anew,
              // and the stored ones are outdated.
};

struct OriginalMap {
  OriginalState state = OriginalState::kMissing;
  std::filesystem::path path;
};

// The originals of an image's maps.
struct OriginalMaps {
  OriginalMap depth;
  OriginalMap normal;
};

// Checks both maps of an image. Throws Error kMismatch where an original is
// lost or its stored file was changed, where refined maps were edited (they are
// no originals), and where the origin of the maps in place is unknown. The
// message tells the user how to decide.
OriginalMaps FindOriginals(const MapPaths& paths,
                           Scrutiny scrutiny = Scrutiny::kContent);

// Throws Error kMismatch where the files beside an image's maps show that they
// were refined, but stereo/tsar, which held their originals, is gone: refined
// maps are no originals.
void RequireNoStrayResults(const MapPaths& paths);

// Moves a file that has to make room for another map to stereo/tsar/superseded,
// where this program never touches it again, and returns its new path; the
// caller tells the user. path: the file; map: its map in stereo, whose name it
// keeps, with a number appended where that is taken.
ContainedPath Supersede(const ContainedPath& path, const ContainedPath& map);

}  // namespace tsar
