// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/file_id.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

enum class ImageStatus {
  kPending,  // Not done.
  kDone,     // The refined maps are in place, or about to be.
  kKept,     // The original maps were left as they are; the note says why.
  kFailed,   // An error; the note says which.
};

std::string ToString(ImageStatus status);

// The record of one image's maps of one type, stored as
// stereo/tsar/records/NAME.TYPE.json. It is written before the first map is
// renamed into place, so that a file there is this program's if, and only if,
// the record lists it. The caller of WriteRefined fills in what the maps were
// made from, counts, seconds and note, WriteRefined the rest.
struct ImageRecord {
  std::string image;
  std::string type;
  ImageStatus status = ImageStatus::kPending;
  std::string options_hash;
  // The fingerprints of the inputs of the run (see InputFingerprints), and of
  // the planes of the scene; the last is empty where there were none.
  std::string inputs;
  std::string planes;
  // The files of this program by "depth", "normal" and the names in
  // ResultFiles(): the latest, then one that it may not have replaced yet.
  std::map<std::string, std::vector<FileId>> files;
  std::map<std::string, int64_t> counts;
  std::map<std::string, double> seconds;
  std::string note;

  // Whether the latest file of this name is in this place.
  bool Has(const std::string& name, const std::filesystem::path& path) const;
};

// Flushes a file that is to be listed in a record, and returns its id, which
// renaming does not change. path: its name; hash: of its content, 0 if unknown.
FileId IdOfPrepared(const ContainedPath& path, AtomicFile* file, uint64_t hash);

// Nothing where there is no such file; Error kCorrupt where it is not a record.
std::optional<ImageRecord> ReadRecord(const std::filesystem::path& path);

// ReadRecord(), but nothing and a warning instead of Error kCorrupt.
std::optional<ImageRecord> ReadRecordIfValid(const std::filesystem::path& path);

// Writes the record atomically; creates the folder.
void WriteRecord(const ContainedPath& path, const ImageRecord& record);

}  // namespace tsar
