// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/merge_shards.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/controllers/evidence_store.h"
#include "colmap_tsar/controllers/open_workspace.h"
#include "colmap_tsar/controllers/scene_model_store.h"
#include "colmap_tsar/controllers/shard.h"
#include "colmap_tsar/controllers/shard_entries.h"
#include "colmap_tsar/pipeline/refine_option_list.h"
#include "colmap_tsar/store/manifest.h"
#include "colmap_tsar/store/shard_record.h"
#include "colmap_tsar/store/workspace_lock.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tsar {
namespace {

std::map<std::string, std::string> RuntimeOfShards(
    const std::vector<ShardRecord>& shards) {
  std::map<std::string, std::string> runtime = {
      {"shards", std::to_string(shards.size())}};
  for (const ShardRecord& shard : shards) {
    const std::string name =
        "shard " + ToString(Shard{shard.index, shard.count});
    for (const auto& [key, value] : shard.runtime) {
      runtime[name + ", " + key] = value;
    }
  }
  return runtime;
}

// By what the shards were run with, whatever masks the merge is given.
std::optional<int64_t> MasksOfShards(const std::vector<ShardRecord>& shards) {
  std::optional<int64_t> num_masks;
  for (const ShardRecord& shard : shards) {
    if (shard.num_masks) {
      num_masks = num_masks.value_or(0) + *shard.num_masks;
    }
  }
  return num_masks;
}

void RequireAllDone(const Workspace& workspace, const Manifest& manifest) {
  const int num_done = manifest.NumImages(ImageStatus::kDone) +
                       manifest.NumImages(ImageStatus::kKept);
  if (num_done < static_cast<int>(manifest.images.size())) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.Root().string(),
        std::to_string(manifest.images.size() - static_cast<size_t>(num_done)) +
            " of " + std::to_string(manifest.images.size()) +
            " images have not been refined with these options",
        "run " + OptionName("pass") +
            " observe of all shards, model, and compose of all shards first");
  }
}

}  // namespace

RunSummary MergeShards(const WorkspaceRefineOptions& workspace_options,
                       const RefineOptions& refine_options) {
  const Stopwatch stopwatch;
  const Workspace workspace = OpenWorkspace(workspace_options);
  const WorkspaceLock lock(workspace.Root());
  std::vector<ShardRecord> shards;
  if (const int count =
          CountShards(workspace, refine_options, RefinePass::kMerge);
      count > 0) {
    shards = ReadCompleteShards(
        workspace.Root(),
        DescribeShard(
            workspace, refine_options, RefinePass::kMerge, {0, count}),
        RefinePass::kCompose);
  }
  Manifest manifest = BuildManifest(workspace,
                                    RefineOptionsText(refine_options),
                                    HashRefineOptions(refine_options));
  RequireAllDone(workspace, manifest);
  const std::optional<int64_t> num_masks = MasksOfShards(shards);
  if (!shards.empty()) {
    manifest.runtime = RuntimeOfShards(shards);
    NoteMasks(num_masks, &manifest);
    WriteManifest(workspace, manifest);
  }
  EvidenceStore::Clear(workspace);
  SceneModelStore::DropLabels(workspace);
  // Last: until then, the same call does all of it again.
  RemoveShardRecords(workspace.Root());

  RunSummary summary;
  summary.workspace_path = workspace.Root();
  summary.model_folder = workspace.ModelFolder();
  summary.type = workspace.Type();
  summary.pass = RefinePass::kMerge;
  summary.num_images = static_cast<int>(manifest.images.size());
  summary.num_refined = manifest.NumImages(ImageStatus::kDone);
  summary.num_masks = num_masks;
  for (const Manifest::Entry& entry : manifest.images) {
    if (entry.status == ImageStatus::kKept) {
      summary.kept.push_back({entry.image, entry.note});
    }
  }
  summary.counts = manifest.counts;
  summary.seconds = manifest.seconds;
  summary.wall_seconds = stopwatch.Seconds();
  return summary;
}

}  // namespace tsar
