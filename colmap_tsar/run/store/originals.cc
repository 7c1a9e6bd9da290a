// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/originals.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/result_files.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <system_error>

namespace tsar {
namespace {

namespace fs = std::filesystem;

bool HaveSameLength(const fs::path& a, const fs::path& b) {
  std::error_code error;
  const uintmax_t length = fs::file_size(a, error);
  return !error && length == fs::file_size(b, error) && !error;
}

// The size of a map; nothing where it is not complete.
std::optional<MapSize> SizeIfComplete(const fs::path& path) {
  try {
    return ReadMapSize(path);
  } catch (const Error& error) {
    if (error.Code() == ErrorCode::kCorrupt ||
        error.Code() == ErrorCode::kNotFound) {
      return std::nullopt;
    }
    throw;
  }
}

bool HaveSameSize(const MapSize& a, const MapSize& b) {
  return a.width == b.width && a.height == b.height && a.channels == b.channels;
}

// The number of compared values, and of those that are still as written.
struct Comparison {
  int num_compared = 0;
  int num_same = 0;
};

Comparison CompareSamples(const std::vector<uint32_t>& current,
                          const std::vector<uint32_t>& original,
                          const std::vector<uint32_t>& written) {
  Comparison comparison;
  for (size_t i = 0; i < std::min(current.size(), written.size()); ++i) {
    // Zero means no value. A value that equals the original's tells nothing:
    // patch_match_stereo may have computed it again.
    const bool is_same = current[i] == written[i];
    const bool tells =
        !is_same || original.empty() || written[i] != original[i];
    if (current[i] != 0 && written[i] != 0 && tells) {
      ++comparison.num_compared;
      comparison.num_same += is_same ? 1 : 0;
    }
  }
  return comparison;
}

// The state of a complete map with none of the fingerprints.
MapState CompareValues(const fs::path& current,
                       const MapSize& size,
                       const fs::path& original,
                       const std::vector<WrittenMap>& written) {
  const int64_t time = TimeOf(current);
  const MapState foreign =
      std::ranges::find(written, time, &WrittenMap::time) != written.end()
          ? MapState::kUnknown
          : MapState::kNew;
  std::vector<uint32_t> original_samples;
  if (const std::optional<MapSize> original_size = SizeIfComplete(original)) {
    if (!HaveSameSize(size, *original_size)) {
      return foreign;  // This program writes the original's size.
    }
    original_samples = ReadSamples(original);
  }
  const std::vector<uint32_t> samples = ReadSamples(current);
  bool is_made_of_none = true;
  for (const WrittenMap& map : written) {
    const Comparison comparison =
        CompareSamples(samples, original_samples, map.samples);
    // An edit changes some values and leaves the others as they are.
    if (comparison.num_same > 0 &&
        4 * comparison.num_same >= comparison.num_compared) {
      return MapState::kEdited;
    }
    is_made_of_none = is_made_of_none && comparison.num_compared > 0 &&
                      comparison.num_same == 0;
  }
  return is_made_of_none ? foreign : MapState::kUnknown;
}

// One of the two maps of an image.
struct Map {
  const ContainedPath& current;
  const ContainedPath& stored;
  const MapRecord* record;        // Null without one.
  std::optional<MapState> state;  // Nothing where no original is stored.
};

Map Inspect(const ContainedPath& current,
            const ContainedPath& stored,
            const MapRecord* record,
            Scrutiny scrutiny) {
  Map map = {current, stored, record, std::nullopt};
  if (Exists(stored)) {
    map.state = InspectMap(
        current, stored, record ? &record->written : nullptr, scrutiny);
  }
  return map;
}

// The state of a map without a stored original.
OriginalState FindInPlace(const Map& map, Scrutiny scrutiny) {
  if (!Exists(map.current)) {
    return OriginalState::kMissing;
  }
  if (IsRefined(map.current, map.record, scrutiny)) {
    throw Error::File(ErrorCode::kMismatch,
                      map.current.string(),
                      "this map has been refined and its original, " +
                          map.stored.string() + ", is gone",
                      "run patch_match_stereo again for this image");
  }
  return OriginalState::kInPlace;
}

void RequireUnedited(const Map& map) {
  if (map.state == MapState::kEdited) {
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

void RequireOriginal(const Map& map, Scrutiny scrutiny) {
  if (IsStoredChanged(map.state,
                      map.stored,
                      map.record ? map.record->original : std::nullopt,
                      scrutiny)) {
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

// The state of the maps with a stored original.
OriginalState CheckStored(const Map& depth,
                          const Map& normal,
                          Scrutiny scrutiny) {
  const MapOwner owner = FindOwner(depth.state, normal.state);
  if (owner == MapOwner::kOtherProgram) {
    // The stored maps are outdated and not read.
    return OriginalState::kReplaced;
  }
  RequireOriginal(depth, scrutiny);
  RequireOriginal(normal, scrutiny);
  if (owner == MapOwner::kUndecided) {
    const bool is_depth_foreign =
        depth.state == MapState::kNew || depth.state == MapState::kUnknown;
    is_depth_foreign ? ThrowUndecided(depth, normal)
                     : ThrowUndecided(normal, depth);
  }
  RequireUnedited(depth);
  RequireUnedited(normal);
  return OriginalState::kStored;
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

bool IsTaken(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type() != fs::file_type::not_found;
}

}  // namespace

MapState InspectMap(const fs::path& current,
                    const fs::path& original,
                    const std::vector<WrittenMap>* written,
                    Scrutiny scrutiny) {
  if (!Exists(current)) {
    return MapState::kMissing;
  }
  std::error_code error;
  if (fs::equivalent(current, original, error)) {
    return MapState::kOriginal;
  }
  if (!IsFile(current)) {
    return MapState::kDamaged;
  }
  if (written != nullptr && IsAnyOf(current, *written, scrutiny)) {
    return MapState::kWritten;
  }
  if (HaveSameLength(current, original) &&
      HashFile(original) == HashFile(current)) {
    return MapState::kOriginal;
  }
  const std::optional<MapSize> size = SizeIfComplete(current);
  if (!size) {
    return MapState::kDamaged;
  }
  return written == nullptr ? MapState::kUnknown
                            : CompareValues(current, *size, original, *written);
}

bool IsRefined(const fs::path& current,
               const MapRecord* record,
               Scrutiny scrutiny) {
  if (record && record->original && IsFile(current) &&
      IsAnyOf(current, {*record->original}, scrutiny)) {
    return false;
  }
  const MapState state =
      InspectMap(current, {}, record ? &record->written : nullptr, scrutiny);
  return state == MapState::kWritten || state == MapState::kEdited;
}

bool IsStoredChanged(std::optional<MapState> state,
                     const fs::path& stored,
                     const std::optional<WrittenMap>& original,
                     Scrutiny scrutiny) {
  if (!state || state == MapState::kOriginal) {
    return false;
  }
  return !IsFile(stored) || (original ? !IsAnyOf(stored, {*original}, scrutiny)
                                      : !SizeIfComplete(stored));
}

MapOwner FindOwner(std::optional<MapState> depth,
                   std::optional<MapState> normal) {
  const auto is_of_this_program = [](std::optional<MapState> state) {
    return state != MapState::kNew && state != MapState::kUnknown;
  };
  const auto is_new = [](std::optional<MapState> state) {
    return !state || state == MapState::kNew;
  };
  if (is_of_this_program(depth) && is_of_this_program(normal)) {
    return MapOwner::kThisProgram;
  }
  return is_new(depth) && is_new(normal) ? MapOwner::kOtherProgram
                                         : MapOwner::kUndecided;
}

OriginalMaps FindOriginals(const MapPaths& paths, Scrutiny scrutiny) {
  const std::optional<ImageRecord> record = ReadRecord(paths.record);
  const Map depth = Inspect(paths.depth,
                            paths.original_depth,
                            record ? &record->depth : nullptr,
                            scrutiny);
  const Map normal = Inspect(paths.normal,
                             paths.original_normal,
                             record ? &record->normal : nullptr,
                             scrutiny);
  const OriginalState state_of_stored = CheckStored(depth, normal, scrutiny);
  // A killed run may have stored only one of the two.
  const auto locate = [&](const Map& map) -> OriginalMap {
    const OriginalState state =
        map.state ? state_of_stored : FindInPlace(map, scrutiny);
    return {state, state == OriginalState::kStored ? map.stored : map.current};
  };
  return {locate(depth), locate(normal)};
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

ContainedPath Supersede(const ContainedPath& path, const ContainedPath& map) {
  const ContainedPath folder = GetSupersededFolder(map.Root());
  const fs::path name = map.Relative().lexically_relative("stereo");
  ContainedPath target = folder / name;
  for (int number = 2; IsTaken(target); ++number) {
    target = folder / (name.string() + "." + std::to_string(number));
  }
  CreateFolders(target.Parent());
  RenameFile(path, target);
  return target;
}

}  // namespace tsar
