// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/record.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/store/json_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

namespace tsar {

namespace {

constexpr std::array kStatusNames = {
    std::pair(ImageStatus::kPending, "pending"),
    std::pair(ImageStatus::kDone, "done"),
    std::pair(ImageStatus::kKept, "kept"),
    std::pair(ImageStatus::kFailed, "failed"),
};

}  // namespace

std::string ToString(ImageStatus status) {
  return EnumName(kStatusNames, status);
}

// The conversions that nlohmann::json looks for.
static void to_json(nlohmann::json& json, const FileId& id) {
  json = ToText(id);
}
static void from_json(const nlohmann::json& json, FileId& id) {
  const std::optional<FileId> read = FileIdFromText(json.get<std::string>());
  if (!read) {
    throw std::invalid_argument("no file's size and time");
  }
  id = *read;
}
static void to_json(nlohmann::json& json, const ImageStatus& status) {
  json = ToString(status);
}
static void from_json(const nlohmann::json& json, ImageStatus& status) {
  status = FindEnumValue(kStatusNames, json.get<std::string>()).value();
}
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ImageRecord,
                                   image,
                                   type,
                                   status,
                                   options_hash,
                                   inputs,
                                   planes,
                                   files,
                                   counts,
                                   seconds,
                                   note)

bool ImageRecord::Has(const std::string& name,
                      const std::filesystem::path& path) const {
  const auto found = files.find(name);
  return found != files.end() && IsUnchanged(path, found->second.front());
}

FileId IdOfPrepared(const ContainedPath& path,
                    AtomicFile* file,
                    uint64_t hash) {
  file->Prepare();
  const std::filesystem::path temporary =
      path.string() + AtomicFile::kTemporarySuffix;
  std::optional<FileId> id = FindFileId(temporary);
  if (!id) {
    ThrowSystemError(temporary, "was removed", ENOENT);
  }
  id->hash = hash != 0 ? hash : HashFile(temporary);
  return *id;
}

std::optional<ImageRecord> ReadRecord(const std::filesystem::path& path) {
  InputFile file(path);
  if (file.IsMissing()) {
    return std::nullopt;
  }
  if (!file) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "the record cannot be read (" + file.Reason() + ")",
                      "check that it is a file and that you may read it");
  }
  try {
    ImageRecord record = nlohmann::json::parse(file);
    const auto names_file = [](const auto& ids) { return !ids.second.empty(); };
    if (std::ranges::all_of(record.files, names_file)) {
      return record;
    }
  } catch (const nlohmann::json::exception&) {
  } catch (const std::bad_optional_access&) {
  } catch (const std::logic_error&) {
    // An invalid status or file.
  }
  throw Error::File(ErrorCode::kCorrupt,
                    path.string(),
                    "not a record of this version",
                    "put the originals back with " + OptionName("restore") +
                        " 1 and start again");
}

std::optional<ImageRecord> ReadRecordIfValid(
    const std::filesystem::path& path) {
  try {
    return ReadRecord(path);
  } catch (const Error& error) {
    if (error.Code() != ErrorCode::kCorrupt) {
      throw;
    }
    Warn(error.what());
    return std::nullopt;
  }
}

void WriteRecord(const ContainedPath& path, const ImageRecord& record) {
  WriteJson(path, record);
}

}  // namespace tsar
