// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/record.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/atomic_file.h"

#include <array>
#include <cinttypes>
#include <cstdio>
#include <fstream>
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
                     "put the originals back with --restore 1 and start again");
}

// As text, because JSON numbers are only exact up to 53 bits in many programs.
std::string ToHex(uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016" PRIx64, value);
  return text;
}

uint64_t FromHex(const std::string& text) {
  return std::stoull(text, nullptr, 16);
}

nlohmann::json ToHexList(const std::vector<uint64_t>& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const uint64_t value : values) {
    list.push_back(ToHex(value));
  }
  return list;
}

std::vector<uint64_t> FromHexList(const nlohmann::json& list) {
  std::vector<uint64_t> values;
  for (const nlohmann::json& text : list) {
    values.push_back(FromHex(text.get<std::string>()));
  }
  return values;
}

ImageStatus StatusFromString(const std::string& text) {
  for (const auto& [status, name] : kStatusNames) {
    if (text == name) {
      return status;
    }
  }
  throw std::invalid_argument(text);
}

}  // namespace

std::string ToString(ImageStatus status) {
  return kStatusNames[static_cast<size_t>(status)].second;
}

std::optional<ImageRecord> ReadRecord(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return std::nullopt;
  }
  std::ifstream file(path);
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    ImageRecord record;
    record.version = json.at("version").get<std::string>();
    record.image = json.at("image").get<std::string>();
    record.type = json.at("type").get<std::string>();
    record.status = StatusFromString(json.at("status").get<std::string>());
    record.options_hash = json.at("options_hash").get<std::string>();
    record.inputs = json.value("inputs", record.inputs);
    record.depth_hashes = FromHexList(json.at("depth_hashes"));
    record.normal_hashes = FromHexList(json.at("normal_hashes"));
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

void WriteRecord(const std::filesystem::path& path, const ImageRecord& record) {
  const nlohmann::json json = {
      {"version", record.version},
      {"image", record.image},
      {"type", record.type},
      {"status", ToString(record.status)},
      {"options_hash", record.options_hash},
      {"inputs", record.inputs},
      {"depth_hashes", ToHexList(record.depth_hashes)},
      {"normal_hashes", ToHexList(record.normal_hashes)},
      {"original_depth_hash", ToHex(record.original_depth_hash)},
      {"original_normal_hash", ToHex(record.original_normal_hash)},
      {"counts", record.counts},
      {"seconds", record.seconds},
      {"note", record.note},
  };
  CreateFolders(path.parent_path());
  AtomicFile file(path);
  // Names need not be UTF-8; the replacement character stands for the rest.
  file.Stream() << json.dump(
                       2, ' ', false, nlohmann::json::error_handler_t::replace)
                << "\n";
  file.Commit();
}

}  // namespace tsar
