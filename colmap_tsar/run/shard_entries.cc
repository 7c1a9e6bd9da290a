// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/shard_entries.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <optional>
#include <utility>

namespace tsar {
namespace {

constexpr size_t kMaxListed = 10;

std::string ObserveAgain() {
  return "run " + OptionName("pass") + " observe of all shards again";
}

std::string HashImages(const Workspace& workspace) {
  ContentHash hash;
  const auto add = [&](int image) {
    const std::string& name = workspace.Name(image);
    hash.Update(name.c_str(), name.size() + 1);
  };
  for (const StereoProblem& problem : workspace.Problems()) {
    add(problem.reference);
    for (const int source : problem.sources) {
      add(source);
    }
    hash.Update("", 1);
  }
  return std::to_string(hash.Value());
}

void RequireNoOtherWork(const std::filesystem::path& root,
                        const ShardRecord& own) {
  for (const auto& [path, record] : ListShardRecords(root)) {
    RequireSameWork(own, record, path);
  }
}

std::optional<ShardRecord> ReadIfThere(const std::filesystem::path& path) {
  try {
    return ReadShardRecord(path);
  } catch (const Error& error) {
    if (error.Code() == ErrorCode::kNotFound) {
      return std::nullopt;
    }
    throw;
  }
}

// The process there was killed, or still runs where no lock shows it.
void WarnOfOtherMachine(const ShardRecord& own, const ShardRecord& earlier) {
  const auto host = earlier.runtime.find("host");
  if (!earlier.is_complete && host != earlier.runtime.end() &&
      host->second != own.runtime.at("host")) {
    Warn("shard " + std::to_string(own.index) + " of " +
         std::to_string(own.count) + " was begun on " + host->second +
         " and has not come to its end; going on with it here");
  }
}

std::string FirstNote(const ShardRecord& record) {
  for (const ShardRecord::Entry& entry : record.images) {
    if (!entry.note.empty()) {
      return " (" + entry.image + ": " + entry.note + ")";
    }
  }
  return "";
}

}  // namespace

ShardRecord DescribeShard(const Workspace& workspace,
                          const RefineOptions& options,
                          RefinePass pass,
                          const Shard& shard) {
  ShardRecord record;
  record.version = TSAR_VERSION;
  record.type = ToString(workspace.Type());
  record.options = RefineOptionsText(options);
  record.options_hash = HashRefineOptions(options);
  record.images_hash = HashImages(workspace);
  record.pass = ToString(pass);
  record.index = shard.index;
  record.count = shard.count;
  return record;
}

int CountShards(const Workspace& workspace,
                const RefineOptions& options,
                RefinePass pass) {
  int count = 0;
  for (const auto& [path, record] : ListShardRecords(workspace.Root())) {
    count = count == 0 ? record.count : count;
    RequireSameWork(
        DescribeShard(workspace, options, pass, {0, count}), record, path);
  }
  return count;
}

void BeginShard(const std::filesystem::path& root, const ShardRecord& own) {
  RequireNoOtherWork(root, own);
  const ContainedPath path = GetShardPath(root, own.pass, own.index, own.count);
  const std::optional<ShardRecord> earlier = ReadIfThere(path);
  if (earlier) {
    WarnOfOtherMachine(own, *earlier);
  }
  WriteShardRecord(root, own);
  try {
    // Of two shards that begin at the same time, at least one sees the other.
    RequireNoOtherWork(root, own);
  } catch (const Error&) {
    if (!earlier) {
      RemoveFile(path);
      RemoveFolderIfEmpty(GetShardFolder(root));
    }
    throw;
  }
  if (own.pass == ToString(RefinePass::kObserve)) {
    RemoveFile(GetShardPath(
        root, ToString(RefinePass::kCompose), own.index, own.count));
  }
}

std::vector<ShardRecord> ReadCompleteShards(const std::filesystem::path& root,
                                            const ShardRecord& own,
                                            RefinePass pass) {
  std::vector<ShardRecord> records;
  std::string missing;
  std::string note;
  size_t num_missing = 0;
  for (int index = 0; index < own.count; ++index) {
    const std::filesystem::path path =
        GetShardPath(root, ToString(pass), index, own.count);
    std::optional<ShardRecord> record = ReadIfThere(path);
    if (record) {
      RequireSameWork(own, *record, path);
    }
    if (record && record->is_complete) {
      records.push_back(std::move(*record));
      continue;
    }
    if (++num_missing <= kMaxListed) {
      missing += (missing.empty() ? "" : ", ") + std::to_string(index);
    }
    if (record && note.empty()) {
      note = FirstNote(*record);
    }
  }
  if (num_missing > kMaxListed) {
    missing += " and " + std::to_string(num_missing - kMaxListed) + " more";
  }
  if (num_missing > 0) {
    throw Error::File(
        ErrorCode::kNotFound,
        GetShardFolder(root).string(),
        "of the " + std::to_string(own.count) + " shards, " + missing +
            (num_missing == 1 ? " has" : " have") +
            " not come to the end of the pass " + ToString(pass) + note,
        "run " + OptionName("pass") + " " + ToString(pass) + " of " +
            (num_missing == 1 ? "it" : "them") + " first");
  }
  return records;
}

ObservedShards ReadObservedShards(
    const Workspace& workspace,
    const ShardRecord& own,
    const std::vector<std::vector<size_t>>& shards) {
  ObservedShards observed;
  const std::vector<ShardRecord> records =
      ReadCompleteShards(workspace.Root(), own, RefinePass::kObserve);
  for (size_t shard = 0; shard < shards.size(); ++shard) {
    const std::filesystem::path path =
        GetShardPath(workspace.Root(),
                     ToString(RefinePass::kObserve),
                     static_cast<int>(shard),
                     own.count);
    if (records[shard].inputs != own.inputs) {
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "inputs of the run have changed since that shard was "
                        "observed",
                        ObserveAgain());
    }
    if (records[shard].images.size() != shards[shard].size()) {
      throw Error::File(
          ErrorCode::kMismatch,
          path.string(),
          "names " + std::to_string(records[shard].images.size()) +
              " images, not " + std::to_string(shards[shard].size()),
          ObserveAgain());
    }
    for (size_t i = 0; i < shards[shard].size(); ++i) {
      const int image = workspace.Problems()[shards[shard][i]].reference;
      const ShardRecord::Entry& entry = records[shard].images[i];
      observed.states[image] = entry.state;
      if (entry.state == ShardRecord::State::kObserved) {
        observed.with_evidence.insert(image);
      }
    }
  }
  return observed;
}

void RequireObserved(const Workspace& workspace,
                     int image,
                     const ObservedShards& observed) {
  const auto found = observed.states.find(image);
  if (found != observed.states.end() &&
      found->second == ShardRecord::State::kNotNeeded) {
    throw Error(ErrorCode::kNotFound,
                workspace.Name(image) +
                    ": nobody needed what is observed in it, but now another "
                    "image has to be refined again; " +
                    ObserveAgain());
  }
}

}  // namespace tsar
