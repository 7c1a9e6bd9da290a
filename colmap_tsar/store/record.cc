// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/record.h"

#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/store/json_file.h"

#include <array>
#include <cinttypes>
#include <cstdio>
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

Error CorruptRecord(const std::filesystem::path& path) {
  return Error::File(ErrorCode::kCorrupt,
                     path.string(),
                     "not a record of this program",
                     "put the originals back with " + OptionName("restore") +
                         " 1 and start again");
}

// As text, because JSON numbers are only exact up to 53 bits in many programs.
// Zero stands for none.
std::string ToHex(std::optional<uint64_t> hash) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016" PRIx64, hash.value_or(0));
  return text;
}

std::optional<uint64_t> FromHex(const std::string& text) {
  const uint64_t value = std::stoull(text, nullptr, 16);
  return value == 0 ? std::nullopt : std::optional(value);
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
    record.inputs = json.value("inputs", record.inputs);
    record.written_depth = WrittenFromJson(json.at("written_depth"));
    record.written_normal = WrittenFromJson(json.at("written_normal"));
    record.has_sigma = json.value("has_sigma", record.has_sigma);
    record.original_depth_hash =
        FromHex(json.at("original_depth_hash").get<std::string>());
    record.original_normal_hash =
        FromHex(json.at("original_normal_hash").get<std::string>());
    record.counts = json.at("counts").get<std::map<std::string, int64_t>>();
    record.seconds = json.at("seconds").get<std::map<std::string, double>>();
    record.note = json.at("note").get<std::string>();
    return record;
  } catch (const nlohmann::json::exception&) {
    throw CorruptRecord(path);
  } catch (const std::logic_error&) {
    // A status or a fingerprint that is none.
    throw CorruptRecord(path);
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
      {"has_sigma", record.has_sigma},
      {"original_depth_hash", ToHex(record.original_depth_hash)},
      {"original_normal_hash", ToHex(record.original_normal_hash)},
      {"counts", record.counts},
      {"seconds", record.seconds},
      {"note", record.note},
  };
  WriteJson(path, json);
}

}  // namespace tsar
