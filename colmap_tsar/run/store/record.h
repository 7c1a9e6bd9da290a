// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/io/written_map.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

enum class ImageStatus {
  kPending,  // Not begun.
  kWriting,  // The refined maps are being given their names.
  kDone,     // The refined maps are in place.
  kKept,     // The original maps were left as they are; the note says why.
  kFailed,   // An error; the note says which.
};

std::string ToString(ImageStatus status);

// The record of a depth or normal map.
struct MapRecord {
  // The maps of this program that may be in place, the latest first. More than
  // one only while maps are being replaced.
  std::vector<WrittenMap> written;
  // The original that the map was made from, to recognize one that was put back
  // or whose stored file was changed. Nothing in output workspaces.
  std::optional<WrittenMap> original;
};

// The record of one image's maps of one type, stored as
// stereo/tsar/records/NAME.TYPE.json. The caller of WriteBack fills in
// options_hash, inputs, counts, seconds and note, WriteBack the rest.
struct ImageRecord {
  std::string version;  // The version of the writing program.
  std::string image;
  std::string type;
  ImageStatus status = ImageStatus::kPending;
  std::string options_hash;
  // The inputs of the maps, as fingerprints by input name.
  std::map<std::string, std::string> inputs;
  // The input with the fingerprint of the planes of the scene; empty where
  // there were none.
  static constexpr const char* kPlanes = "planes";
  MapRecord depth;
  MapRecord normal;
  // The files that belong to the maps, by their names in ResultFiles().
  std::map<std::string, WrittenMap> results;
  std::map<std::string, int64_t> counts;
  std::map<std::string, double> seconds;
  std::string note;
};

// Nothing where there is no such file; Error kCorrupt where it is not a record,
// or the record of another image.
std::optional<ImageRecord> ReadRecord(const std::filesystem::path& path);

// ReadRecord(), but nothing and a warning instead of Error kCorrupt.
std::optional<ImageRecord> ReadRecordIfValid(const std::filesystem::path& path);

// Writes the record atomically; creates the folder.
void WriteRecord(const ContainedPath& path, const ImageRecord& record);

}  // namespace tsar
