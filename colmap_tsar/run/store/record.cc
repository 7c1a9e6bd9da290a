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
namespace {

constexpr std::array kStatusNames = {
    std::pair(ImageStatus::kPending, "pending"),
    std::pair(ImageStatus::kWriting, "writing"),
    std::pair(ImageStatus::kDone, "done"),
    std::pair(ImageStatus::kKept, "kept"),
    std::pair(ImageStatus::kFailed, "failed"),
};

Error CorruptRecord(const std::filesystem::path& path,
                    const std::string& what = "not a record of this program") {
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

nlohmann::json ToJson(const std::vector<WrittenMap>& maps) {
  nlohmann::json list = nlohmann::json::array();
  for (const WrittenMap& map : maps) {
    list.push_back(ToText(map));
  }
  return list;
}

std::vector<WrittenMap> WrittenFromJson(const nlohmann::json& list) {
  std::vector<WrittenMap> maps;
  for (const nlohmann::json& entry : list) {
    maps.push_back(WrittenMapFromText(entry.get<std::string>()));
  }
  return maps;
}

std::string OriginalToText(const std::optional<WrittenMap>& map) {
  return map ? ToText(*map) : "";
}

std::optional<WrittenMap> OriginalFromJson(const nlohmann::json& json) {
  const std::string text = json.get<std::string>();
  return text.empty() ? std::nullopt : std::optional(WrittenMapFromText(text));
}

nlohmann::json ToJson(const std::map<std::string, WrittenMap>& files) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [name, file] : files) {
    json[name] = ToText(file);
  }
  return json;
}

std::map<std::string, WrittenMap> ResultsFromJson(const nlohmann::json& json) {
  std::map<std::string, WrittenMap> files;
  for (const auto& [name, text] :
       json.get<std::map<std::string, std::string>>()) {
    files[name] = WrittenMapFromText(text);
  }
  return files;
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
    record.written_depth = WrittenFromJson(json.at("written_depth"));
    record.written_normal = WrittenFromJson(json.at("written_normal"));
    record.results = ResultsFromJson(json.at("results"));
    record.original_depth = OriginalFromJson(json.at("original_depth"));
    record.original_normal = OriginalFromJson(json.at("original_normal"));
    record.counts = json.at("counts").get<std::map<std::string, int64_t>>();
    record.seconds = json.at("seconds").get<std::map<std::string, double>>();
    record.note = json.at("note").get<std::string>();
    // The record of another image would make its refined maps originals.
    if (!IsRecordOf(record, path)) {
      throw CorruptRecord(path, "the record of another image");
    }
    return record;
  } catch (const nlohmann::json::exception&) {
    throw CorruptRecord(path);
  } catch (const std::logic_error&) {
    // An invalid status or fingerprint.
    throw CorruptRecord(path);
  }
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
      {"written_depth", ToJson(record.written_depth)},
      {"written_normal", ToJson(record.written_normal)},
      {"results", ToJson(record.results)},
      {"original_depth", OriginalToText(record.original_depth)},
      {"original_normal", OriginalToText(record.original_normal)},
      {"counts", record.counts},
      {"seconds", record.seconds},
      {"note", record.note},
  };
  WriteJson(path, json);
}

}  // namespace tsar
