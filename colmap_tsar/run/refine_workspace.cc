// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/refine_controller.h"
#include "colmap_tsar/run/shard_passes.h"

#include <string>

namespace tsar {

void WorkspaceRefineOptions::Check() const {
  const auto require = [](bool condition, const std::string& message) {
    if (!condition) {
      throw Error(ErrorCode::kBadOption, message);
    }
  };
  require(!workspace_path.empty(),
          OptionName("workspace_path") + " is missing; give it");
  RequirePathOfPriorType(prior_path, prior_type);
  devices.Check();
  shard.Check();
  require(pass != RefinePass::kAll || shard.count == 1,
          OptionName("shard") +
              ": a part of the images needs what is observed in the "
              "others; run " +
              OptionName("pass") +
              " observe for all shards, then model, then "
              "compose for all, then merge");
  require((pass != RefinePass::kModel && pass != RefinePass::kMerge) ||
              shard.count == 1,
          OptionName("shard") + ": " + OptionName("pass") + " " +
              ToString(pass) +
              " is for all shards together; "
              "leave it out");
  require(pass == RefinePass::kAll || image_list_path.empty(),
          OptionName("image_list_path") +
              ": shards work on all images; leave it out, or run " +
              OptionName("pass") + " all");
  require(
      pass == RefinePass::kAll || output_path.empty(),
      OptionName("output_path") +
          ": shards refine in place; leave it out, and make a copy "
          "of links first (cp -as) where the workspace is to stay as it is");
}

RunSummary RefineWorkspace(const WorkspaceRefineOptions& workspace_options,
                           const RefineOptions& refine_options,
                           Progress& progress,
                           const std::function<bool()>& should_stop,
                           RefineObserver* observer) {
  workspace_options.Check();
  refine_options.Check();
  if (!workspace_options.prior_path.empty() && !NeedsEvidence(refine_options)) {
    throw Error(ErrorCode::kBadOption,
                OptionName("prior_path") +
                    ": depth priors are used together with the planes of the "
                    "scene alone; leave it out, or turn " +
                    OptionName("scene_planes") + " on");
  }
  if (workspace_options.pass == RefinePass::kModel) {
    return ModelShards(
        workspace_options, refine_options, progress, should_stop);
  }
  if (workspace_options.pass == RefinePass::kMerge) {
    return MergeShards(workspace_options, refine_options);
  }
  return RefineController(
             workspace_options, refine_options, progress, should_stop, observer)
      .Run();
}

}  // namespace tsar
