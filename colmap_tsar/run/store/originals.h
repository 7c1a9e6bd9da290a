// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/record.h"

#include <filesystem>

namespace tsar {

// The location of the map that COLMAP wrote.
enum class OriginalState {
  kMissing,  // There is no map.
  kInPlace,  // Under its own name; nothing is stored.
  kStored,   // In stereo/tsar/original; the map in its place is this program's.
  kReplaced,  // Under its own name: COLMAP wrote both maps of the image anew,
              // and the stored ones are outdated.
};

// The originals of an image's maps.
struct OriginalMaps {
  OriginalState depth_state = OriginalState::kMissing;
  OriginalState normal_state = OriginalState::kMissing;
  std::filesystem::path depth;
  std::filesystem::path normal;
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

}  // namespace tsar
