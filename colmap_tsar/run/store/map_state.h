// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/written_map.h"

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

// The state of a map whose original is not stored. original: the record of the
// original; nothing without a record. A map with the original's bytes is the
// original, even if this program wrote the same bytes: an interrupted
// restoration has put it there.
MapState InspectMapWithoutOriginal(const std::filesystem::path& current,
                                   const std::vector<WrittenMap>* written,
                                   const std::optional<WrittenMap>& original,
                                   Scrutiny scrutiny = Scrutiny::kContent);

// Whether the file at `stored` is the recorded original or, without a record,
// at least a complete map.
bool IsOriginal(const std::filesystem::path& stored,
                const std::optional<WrittenMap>& original,
                Scrutiny scrutiny = Scrutiny::kContent);

// Whether the file at `stored`, kept while the map in place has this state
// (nothing: none is kept), is not the recorded original. A map that is itself
// the stored one may be newer than the record: a killed run has just kept it.
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

}  // namespace tsar
