// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/record.h"

#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/store/json_file.h"

#include <array>
#include <utility>

#include <nlohmann/json.hpp>

namespace tsar {

// The conversions that nlohmann::json looks for.
static void to_json(nlohmann::json& json, const WrittenMap& map) {
  json = ToText(map);
}
static void from_json(const nlohmann::json& json, WrittenMap& map) {
  map = WrittenMapFromText(json.get<std::string>());
}

namespace {

constexpr std::array kStatusNames = {
    std::pair(ImageStatus::kPending, "pending"),
    std::pair(ImageStatus::kWriting, "writing"),
    std::pair(ImageStatus::kDone, "done"),
    std::pair(ImageStatus::kKept, "kept"),
    std::pair(ImageStatus::kFailed, "failed"),
};

Error CorruptRecord(const std::filesystem::path& path,
                    const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     path.string(),
                     what,
                     "put the originals back with " + OptionName("restore") +
                         " 1 and start again");
}

// See GetMapPaths. Records do not hold names that are not UTF-8 unchanged.
bool IsRecordOf(const ImageRecord& record, const std::filesystem::path& path) {
  const std::string end = "/" + record.image + "." + record.type + ".json";
  return end.find("\xEF\xBF\xBD") != std::string::npos ||
         path.generic_string().ends_with(end);
}

std::string OriginalToText(const std::optional<WrittenMap>& map) {
  return map ? ToText(*map) : "";
}

std::optional<WrittenMap> OriginalFromJson(const nlohmann::json& json) {
  const std::string text = json.get<std::string>();
  return text.empty() ? std::nullopt : std::optional(WrittenMapFromText(text));
}

}  // namespace

std::string ToString(ImageStatus status) {
  return EnumName(kStatusNames, status);
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
    record.version = json.at("version").get<std::string>();
    record.image = json.at("image").get<std::string>();
    record.type = json.at("type").get<std::string>();
    record.status =
        EnumValue(kStatusNames, json.at("status").get<std::string>());
    record.options_hash = json.at("options_hash").get<std::string>();
    record.inputs = json.at("inputs").get<std::map<std::string, std::string>>();
    record.depth.written =
        json.at("written_depth").get<std::vector<WrittenMap>>();
    record.normal.written =
        json.at("written_normal").get<std::vector<WrittenMap>>();
    record.results =
        json.at("results").get<std::map<std::string, WrittenMap>>();
    record.depth.original = OriginalFromJson(json.at("original_depth"));
    record.normal.original = OriginalFromJson(json.at("original_normal"));
    record.counts = json.at("counts").get<std::map<std::string, int64_t>>();
    record.seconds = json.at("seconds").get<std::map<std::string, double>>();
    record.note = json.at("note").get<std::string>();
    // The record of another image would make its refined maps originals.
    if (!IsRecordOf(record, path)) {
      throw CorruptRecord(path, "the record of another image");
    }
    return record;
  } catch (const nlohmann::json::exception&) {
  } catch (const std::logic_error&) {
    // An invalid status or fingerprint.
  }
  throw CorruptRecord(path, "not a record of this program");
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
  const nlohmann::json json = {
      {"version", record.version},
      {"image", record.image},
      {"type", record.type},
      {"status", ToString(record.status)},
      {"options_hash", record.options_hash},
      {"inputs", record.inputs},
      {"written_depth", record.depth.written},
      {"written_normal", record.normal.written},
      {"results", record.results},
      {"original_depth", OriginalToText(record.depth.original)},
      {"original_normal", OriginalToText(record.normal.original)},
      {"counts", record.counts},
      {"seconds", record.seconds},
      {"note", record.note},
  };
  WriteJson(path, json);
}

}  // namespace tsar
