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

// What is known about one image's maps of one type, kept as
// stereo/tsar/records/NAME.TYPE.json. The caller of WriteRefined fills in
// options_hash, inputs, counts, seconds and note; the rest is filled in there.
struct ImageRecord {
  std::string version;  // Of the program that wrote it.
  std::string image;
  std::string type;
  ImageStatus status = ImageStatus::kPending;
  std::string options_hash;
  // What the maps were made from, as fingerprints by the names of its parts.
  std::map<std::string, std::string> inputs;
  // Which of them is that of the planes of the scene; empty where there were
  // none.
  static constexpr const char* kPlanes = "planes";
  // The maps of this program that may be in place, the latest first. More than
  // one only while maps are being replaced.
  std::vector<WrittenMap> written_depth;
  std::vector<WrittenMap> written_normal;
  // The files that belong to the maps, by the names of ResultFiles().
  std::map<std::string, WrittenMap> results;
  // The originals that the maps were made from: by them an original that was
  // put back is known, and one that was changed where it is kept. Nothing in
  // output workspaces.
  std::optional<WrittenMap> original_depth;
  std::optional<WrittenMap> original_normal;
  std::map<std::string, int64_t> counts;
  std::map<std::string, double> seconds;
  std::string note;
};

// Nothing where there is no such file; Error kCorrupt where it is not a record,
// or that of another image.
std::optional<ImageRecord> ReadRecord(const std::filesystem::path& path);

// The same, but nothing and a warning in the place of Error kCorrupt.
std::optional<ImageRecord> ReadRecordIfValid(const std::filesystem::path& path);

// In one step; creates the folder.
void WriteRecord(const ContainedPath& path, const ImageRecord& record);

}  // namespace tsar
