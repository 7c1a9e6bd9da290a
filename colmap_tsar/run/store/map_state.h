// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/written_map.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace tsar {

// What stands under the name of a map that this program has replaced, whose
// original it keeps.
enum class MapState {
  kMissing,   // Nothing.
  kWritten,   // What this program wrote.
  kOriginal,  // The same bytes as the original.
  kEdited,    // What this program wrote, edited: masked or thresholded.
  kDamaged,   // No complete map.
  kNew,       // A complete map of other values and of another time than what
              // this program wrote: another one wrote it.
  kUnknown,   // Another map; nothing tells whose.
};

// original: may be missing. written: what may have been written under this
// name; null where no record tells.
MapState InspectMap(const std::filesystem::path& current,
                    const std::filesystem::path& original,
                    const std::vector<WrittenMap>* written,
                    Scrutiny scrutiny = Scrutiny::kContent);

// What stands under the name of a map of which no original is stored.
// original: what was remembered of it; nothing where no record tells. Where the
// map has the original's bytes it is the original, also if this program has
// come to the same ones: a restoration that was interrupted has put it there.
MapState InspectMapWithoutOriginal(const std::filesystem::path& current,
                                   const std::vector<WrittenMap>* written,
                                   const std::optional<WrittenMap>& original,
                                   Scrutiny scrutiny = Scrutiny::kContent);

// Whether what is kept at `stored` is the original that the record tells of
// or, where none does, at least a complete map.
bool IsOriginal(const std::filesystem::path& stored,
                const std::optional<WrittenMap>& original,
                Scrutiny scrutiny = Scrutiny::kContent);

// Whose the maps of an image are, since depth and normals always come from one
// source.
enum class MapOwner {
  kThisProgram,   // Whatever is there: the originals are those that are kept.
  kOtherProgram,  // patch_match_stereo made both anew.
  kUndecided,
};

// Of those of which an original is stored; where one of the two is not, since a
// program was killed between them, the other one tells.
MapOwner FindOwner(std::optional<MapState> depth,
                   std::optional<MapState> normal);

}  // namespace tsar
