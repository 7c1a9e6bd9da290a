// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/map_state.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/file_time.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_io.h"

#include <algorithm>
#include <optional>
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
      std::any_of(written.begin(),
                  written.end(),
                  [&](const WrittenMap& map) { return map.time == time; })
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

MapState InspectMapWithoutOriginal(const fs::path& current,
                                   const std::vector<WrittenMap>* written,
                                   const std::optional<WrittenMap>& original,
                                   Scrutiny scrutiny) {
  if (original && IsFile(current) && IsAnyOf(current, {*original}, scrutiny)) {
    return MapState::kOriginal;
  }
  return InspectMap(current, {}, written, scrutiny);
}

bool IsOriginal(const fs::path& stored,
                const std::optional<WrittenMap>& original,
                Scrutiny scrutiny) {
  return IsFile(stored) && (original ? IsAnyOf(stored, {*original}, scrutiny)
                                     : SizeIfComplete(stored).has_value());
}

bool IsStoredChanged(std::optional<MapState> state,
                     const fs::path& stored,
                     const std::optional<WrittenMap>& original,
                     Scrutiny scrutiny) {
  return state && state != MapState::kOriginal &&
         !IsOriginal(stored, original, scrutiny);
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

}  // namespace tsar
