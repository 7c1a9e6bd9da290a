// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/shard_record.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/json_file.h"

#include <array>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

using State = ShardRecord::State;

constexpr std::array kStateNames = {
    std::pair(State::kNeeded, "needed"),
    std::pair(State::kObserved, "observed"),
    std::pair(State::kNothing, "nothing"),
    std::pair(State::kNotNeeded, "not_needed"),
    std::pair(State::kComposed, "composed"),
};

// Describes the first option that differs, on both sides.
std::string DifferenceOf(const std::map<std::string, std::string>& own,
                         const std::map<std::string, std::string>& other) {
  for (const auto& [name, value] : own) {
    const auto found = other.find(name);
    if (found == other.end() || found->second != value) {
      return "with " + OptionName(name) + " " +
             (found == other.end() ? "missing" : found->second) +
             ", this one " + "with " + value;
    }
  }
  return own == other ? "by another build of this version"
                      : "with other options";
}

}  // namespace

ContainedPath GetShardFolder(const std::filesystem::path& root) {
  return GetTsarFolder(root) / "shards";
}

ContainedPath GetShardPath(const std::filesystem::path& root,
                           const std::string& pass,
                           int index,
                           int count) {
  return GetShardFolder(root) / (pass + "-" + std::to_string(index) + "-of-" +
                                 std::to_string(count) + ".json");
}

ShardRecord ReadShardRecord(const std::filesystem::path& path) {
  InputFile file(path);
  if (file.IsMissing()) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "this shard has not been run",
                      "run it");
  }
  if (!file) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "cannot be read (" + file.Reason() + ")",
                      "check that it is a file and that you may read it");
  }
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    ShardRecord record;
    record.version = json.at("version").get<std::string>();
    record.type = json.at("type").get<std::string>();
    record.options =
        json.at("options").get<std::map<std::string, std::string>>();
    record.options_hash = json.at("options_hash").get<std::string>();
    record.images_hash = json.at("images_hash").get<std::string>();
    record.inputs = json.at("inputs").get<std::string>();
    record.pass = json.at("pass").get<std::string>();
    record.index = json.at("index").get<int>();
    record.count = json.at("count").get<int>();
    record.is_complete = json.at("is_complete").get<bool>();
    record.runtime =
        json.at("runtime").get<std::map<std::string, std::string>>();
    if (json.contains("num_masks")) {
      record.num_masks = json["num_masks"].get<int64_t>();
    }
    if (json.contains("num_priors")) {
      record.num_priors = json["num_priors"].get<int64_t>();
    }
    for (const nlohmann::json& image : json.at("images")) {
      record.images.push_back(
          {image.at("image").get<std::string>(),
           EnumValue(kStateNames, image.at("state").get<std::string>()),
           image.at("note").get<std::string>()});
    }
    // A record under another shard's name would count as that one's.
    if (record.index >= 0 && record.index < record.count &&
        path.filename() ==
            GetShardPath({}, record.pass, record.index, record.count)
                .Filename()) {
      return record;
    }
  } catch (const nlohmann::json::exception&) {
  } catch (const std::invalid_argument&) {
  }
  throw Error::File(ErrorCode::kCorrupt,
                    path.string(),
                    "not a record of a shard",
                    "delete it and run this pass of the shard again");
}

void WriteShardRecord(const std::filesystem::path& root,
                      const ShardRecord& record) {
  nlohmann::json images = nlohmann::json::array();
  for (const ShardRecord::Entry& entry : record.images) {
    images.push_back({{"image", entry.image},
                      {"state", EnumName(kStateNames, entry.state)},
                      {"note", entry.note}});
  }
  nlohmann::json json = {{"version", record.version},
                         {"type", record.type},
                         {"options", record.options},
                         {"options_hash", record.options_hash},
                         {"images_hash", record.images_hash},
                         {"inputs", record.inputs},
                         {"pass", record.pass},
                         {"index", record.index},
                         {"count", record.count},
                         {"is_complete", record.is_complete},
                         {"runtime", record.runtime},
                         {"images", images}};
  if (record.num_masks) {
    json["num_masks"] = *record.num_masks;
  }
  if (record.num_priors) {
    json["num_priors"] = *record.num_priors;
  }
  WriteJson(GetShardPath(root, record.pass, record.index, record.count), json);
}

std::map<std::filesystem::path, ShardRecord> ListShardRecords(
    const std::filesystem::path& root) {
  std::map<std::filesystem::path, ShardRecord> records;
  for (const TreeEntry& entry : ListTree(GetShardFolder(root))) {
    const std::filesystem::path& path = entry.path;
    if (path.extension() != ".json") {
      continue;  // The remains of a killed program.
    }
    try {
      records.emplace(path, ReadShardRecord(path));
    } catch (const Error& failure) {
      // The shard's program may have removed it meanwhile.
      if (failure.Code() != ErrorCode::kNotFound) {
        throw;
      }
    }
  }
  return records;
}

void RemoveShardRecords(const std::filesystem::path& root) {
  const ContainedPath folder = GetShardFolder(root);
  const ContainedPath removed =
      folder.Parent() / (folder.Filename().string() + ".removed");
  RemoveTree(removed);
  if (Folder::OpenIfThere(folder)) {
    RenameFile(folder, removed);
    RemoveTree(removed);
  }
}

void RequireSameWork(const ShardRecord& own,
                     const ShardRecord& other,
                     const std::filesystem::path& path_of_other) {
  std::string difference;
  if (other.count != own.count) {
    difference = "as one of " + std::to_string(other.count) +
                 ", this one as one of " + std::to_string(own.count);
  } else if (other.version != own.version) {
    difference = "by version " + other.version + ", this one by " + own.version;
  } else if (other.type != own.type) {
    difference = "on " + other.type + " maps, this one on " + own.type;
  } else if (other.options_hash != own.options_hash) {
    difference = DifferenceOf(own.options, other.options);
  } else if (other.images_hash != own.images_hash) {
    difference = "when patch-match.cfg named other images or sources";
  }
  if (!difference.empty()) {
    throw Error::File(ErrorCode::kMismatch,
                      path_of_other.string(),
                      "that shard was run " + difference,
                      "run all alike, or delete the folder " +
                          path_of_other.parent_path().string() +
                          " to begin anew");
  }
}

}  // namespace tsar
