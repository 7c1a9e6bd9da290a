// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_record.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/run/store/json_file.h"

#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

constexpr const char* kFormer = "former";

}  // namespace

ContainedPath GetImportFolder(const std::filesystem::path& root) {
  return {root, std::filesystem::path("stereo") / "tsar_import"};
}

ContainedPath GetFormerFolder(const std::filesystem::path& root, size_t kind) {
  return GetImportFolder(root) / "former" / kImportFolders[kind];
}

ContainedPath GetImportRecordFolder(const std::filesystem::path& root) {
  return GetImportFolder(root) / "records";
}

ImportPaths GetImportPaths(const std::filesystem::path& root,
                           const std::string& key) {
  ImportPaths paths;
  for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
    const ContainedPath stereo(root, "stereo");
    paths.maps[kind] = stereo / kImportFolders[kind] / (key + ".bin");
    paths.former[kind] = GetFormerFolder(root, kind) / (key + ".bin");
  }
  paths.record = GetImportRecordFolder(root) / (key + ".json");
  return paths;
}

ImportPaths GetImportPaths(const std::filesystem::path& root,
                           const std::string& image_name,
                           MapType type) {
  return GetImportPaths(root, image_name + "." + ToString(type));
}

std::optional<ImportRecord> ReadImportRecord(
    const std::filesystem::path& path) {
  InputFile file(path);
  if (file.IsMissing()) {
    return std::nullopt;
  }
  ImportRecord record;
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
      for (const nlohmann::json& entry : json.at(kImportFolders[kind])) {
        record.written[kind].push_back(
            WrittenMapFromText(entry.get<std::string>()));
      }
      if (json.contains(kFormer) &&
          json[kFormer].contains(kImportFolders[kind])) {
        record.former[kind] = WrittenMapFromText(
            json[kFormer][kImportFolders[kind]].get<std::string>());
      }
    }
    record.is_being_undone = json.value("is_being_undone", false);
    return record;
  } catch (const nlohmann::json::exception&) {
  } catch (const std::logic_error&) {
    // An unreadable map has no description.
  }
  throw Error::File(ErrorCode::kCorrupt,
                    path.string(),
                    "not a record of this program",
                    "look at the maps in stereo/tsar_import/former, move them "
                    "back by hand and delete stereo/tsar_import");
}

void WriteImportRecord(const ContainedPath& path, const ImportRecord& record) {
  nlohmann::json json;
  for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
    nlohmann::json list = nlohmann::json::array();
    for (const WrittenMap& map : record.written[kind]) {
      list.push_back(ToText(map));
    }
    json[kImportFolders[kind]] = std::move(list);
    if (const std::optional<WrittenMap>& former = record.former[kind]) {
      json[kFormer][kImportFolders[kind]] = ToText(*former);
    }
  }
  json["is_being_undone"] = record.is_being_undone;
  WriteJson(path, json);
}

}  // namespace tsar
