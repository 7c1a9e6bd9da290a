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

#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

namespace tsar {

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
    const nlohmann::json json = nlohmann::json::parse(file);
    ImageRecord record;
    json.at("image").get_to(record.image);
    json.at("type").get_to(record.type);
    record.status =
        EnumValue(kStatusNames, json.at("status").get<std::string>());
    json.at("options_hash").get_to(record.options_hash);
    json.at("inputs").get_to(record.inputs);
    json.at("planes").get_to(record.planes);
    json.at("files").get_to(record.files);
    json.at("counts").get_to(record.counts);
    json.at("seconds").get_to(record.seconds);
    json.at("note").get_to(record.note);
    bool names_files = true;
    for (const auto& [name, ids] : record.files) {
      names_files = names_files && !ids.empty();
    }
    if (names_files) {
      return record;
    }
  } catch (const nlohmann::json::exception&) {
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
  WriteJson(path,
            {{"image", record.image},
             {"type", record.type},
             {"status", ToString(record.status)},
             {"options_hash", record.options_hash},
             {"inputs", record.inputs},
             {"planes", record.planes},
             {"files", record.files},
             {"counts", record.counts},
             {"seconds", record.seconds},
             {"note", record.note}});
}

}  // namespace tsar
