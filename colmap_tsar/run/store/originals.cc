// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/originals.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/run/store/map_state.h"
#include "colmap_tsar/run/store/result_files.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tsar {
namespace {

// One of the two maps of an image.
struct Map {
  const std::filesystem::path& current;
  const std::filesystem::path& stored;
  const std::vector<WrittenMap>* written;
  std::optional<WrittenMap> original;  // The record of the original.
};

// The state of a map without a stored original.
OriginalState FindInPlace(const Map& map, Scrutiny scrutiny) {
  if (!Exists(map.current)) {
    return OriginalState::kMissing;
  }
  const MapState state = InspectMapWithoutOriginal(
      map.current, map.written, map.original, scrutiny);
  if (state == MapState::kWritten || state == MapState::kEdited) {
    throw Error::File(ErrorCode::kMismatch,
                      map.current.string(),
                      "this map has been refined and its original, " +
                          map.stored.string() + ", is gone",
                      "run patch_match_stereo again for this image");
  }
  return OriginalState::kInPlace;
}

void RequireUnedited(const Map& map, std::optional<MapState> state) {
  if (state == MapState::kEdited) {
    throw Error::File(
        ErrorCode::kMismatch,
        map.current.string(),
        "this map was edited after its refinement, so that it is no original; "
        "the original is " +
            map.stored.string(),
        "put the originals back first with " + OptionName("restore") +
            " 1, which keeps the edited "
            "maps in stereo/tsar/superseded");
  }
}

void RequireOriginal(const Map& map,
                     std::optional<MapState> state,
                     Scrutiny scrutiny) {
  if (IsStoredChanged(state, map.stored, map.original, scrutiny)) {
    throw Error::File(
        ErrorCode::kMismatch,
        map.stored.string(),
        "this is not the original of " + map.current.string() +
            " that was kept here",
        "put that one back here, or decide by " + OptionName("restore") +
            " 1 with " + OptionName("restore_conflicts") + " original or keep");
  }
}

// foreign: the map not written by this program; other: the image's other map.
[[noreturn]] void ThrowUndecided(const Map& foreign, const Map& other) {
  throw Error::File(ErrorCode::kMismatch,
                    foreign.current.string(),
                    "nothing tells whether this map and " +
                        other.current.string() + ", or " +
                        foreign.stored.string() + " and " +
                        other.stored.string() + ", are the originals",
                    "decide by " + OptionName("restore") + " 1 with " +
                        OptionName("restore_conflicts") +
                        " original or keep, or run "
                        "patch_match_stereo again for this image");
}

// "stereo/a, stereo/b and stereo/c".
std::string ListResultFolders() {
  std::string list;
  for (size_t i = 0; i < kResultFolders.size(); ++i) {
    if (i > 0) {
      list += i + 1 < kResultFolders.size() ? ", " : " and ";
    }
    list += std::string("stereo/") + kResultFolders[i];
  }
  return list;
}

}  // namespace

OriginalMaps FindOriginals(const MapPaths& paths, Scrutiny scrutiny) {
  const std::optional<ImageRecord> record = ReadRecord(paths.record);
  const Map depth = {paths.depth,
                     paths.original_depth,
                     record ? &record->written_depth : nullptr,
                     record ? record->original_depth : std::nullopt};
  const Map normal = {paths.normal,
                      paths.original_normal,
                      record ? &record->written_normal : nullptr,
                      record ? record->original_normal : std::nullopt};
  const bool has_depth = Exists(depth.stored);
  const bool has_normal = Exists(normal.stored);
  OriginalMaps maps;
  if (has_depth || has_normal) {
    const auto inspect = [&](const Map& map, bool has_stored) {
      return has_stored ? std::optional<MapState>(InspectMap(
                              map.current, map.stored, map.written, scrutiny))
                        : std::nullopt;
    };
    const std::optional<MapState> depth_state = inspect(depth, has_depth);
    const std::optional<MapState> normal_state = inspect(normal, has_normal);
    const MapOwner owner = FindOwner(depth_state, normal_state);
    // Where both maps are newer ones, the stored ones are outdated and not
    // read.
    if (owner != MapOwner::kOtherProgram) {
      RequireOriginal(depth, depth_state, scrutiny);
      RequireOriginal(normal, normal_state, scrutiny);
    }
    if (owner == MapOwner::kUndecided) {
      const bool is_depth_foreign =
          depth_state == MapState::kNew || depth_state == MapState::kUnknown;
      is_depth_foreign ? ThrowUndecided(depth, normal)
                       : ThrowUndecided(normal, depth);
    }
    RequireUnedited(depth, depth_state);
    RequireUnedited(normal, normal_state);
    const OriginalState state = owner == MapOwner::kThisProgram
                                    ? OriginalState::kStored
                                    : OriginalState::kReplaced;
    maps.depth_state = maps.normal_state = state;
  }
  // A killed run may have stored only one of the two.
  if (!has_depth) {
    maps.depth_state = FindInPlace(depth, scrutiny);
  }
  if (!has_normal) {
    maps.normal_state = FindInPlace(normal, scrutiny);
  }
  const auto choose = [](OriginalState state, const Map& map) {
    return state == OriginalState::kStored ? map.stored : map.current;
  };
  maps.depth = choose(maps.depth_state, depth);
  maps.normal = choose(maps.normal_state, normal);
  return maps;
}

void RequireNoStrayResults(const MapPaths& paths) {
  for (const ResultFile& result : ResultFiles(paths)) {
    if (IsFile(*result.path) && !Exists(paths.record) &&
        !Exists(paths.original_depth) && !Exists(paths.original_normal)) {
      throw Error::File(
          ErrorCode::kMismatch,
          paths.depth.string(),
          "this map has been refined, as " + result.path->string() +
              " tells, and stereo/tsar, which held the original, is gone",
          "run patch_match_stereo again and delete " + ListResultFolders() +
              "; delete these alone where the depth and normal maps are the "
              "originals");
    }
  }
}

}  // namespace tsar
