// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/manifest_account.h"

#include "colmap_tsar/base/failure.h"
#include "colmap_tsar/controllers/scene_model_store.h"
#include "colmap_tsar/pipeline/refine_option_list.h"
#include "colmap_tsar/store/output_workspace.h"
#include "colmap_tsar/store/shard_record.h"

#include <string>

namespace tsar {
namespace {

bool WasRefinedBefore(ImageCatalogue& catalogue, size_t index) {
  try {
    return catalogue.HasBeenRefined(index);
  } catch (const Error&) {
    // That it cannot be found out may be what failed.
    return false;
  }
}

}  // namespace

void ManifestAccount::Begin() { WriteManifest(run_.workspace, Build()); }

void ManifestAccount::End(const PipelineOutcome& outcome) {
  Manifest manifest = Build();
  MarkFailures(outcome, &manifest);
  try {
    WriteManifest(run_.workspace, manifest);
  } catch (const Error&) {
    // On a full disk the failure of the image says more.
    outcome.RethrowFailure();
    throw;
  }
  RequireComplete(outcome, run_.catalogue.NumListed());
  // Also what a run with other options left behind.
  EvidenceStore::Clear(run_.workspace);
  if (run_.HasScenePlanes()) {
    SceneModelStore::DropLabels(run_.workspace);
  } else {
    SceneModelStore::Remove(run_.workspace);
  }
  RemoveShardRecords(run_.workspace.Root());
  if (run_.options.output_path.empty() && !run_.workspace.IsOutput()) {
    // Images that keep their maps have got them back from where links lead.
    bool are_all_linked = true;
    RelinkOutputs(run_.workspace.Root(), &are_all_linked);
  }
}

Manifest ManifestAccount::Build() const {
  Manifest manifest = BuildManifest(run_.workspace,
                                    RefineOptionsText(run_.refine_options),
                                    HashRefineOptions(run_.refine_options));
  manifest.runtime = RuntimeText(run_.options.devices, run_.devices);
  if (!run_.options.image_list_path.empty()) {
    manifest.runtime["listed_images"] =
        std::to_string(run_.catalogue.NumListed());
  }
  NoteMasks(run_.NumMasks(), &manifest);
  return manifest;
}

void ManifestAccount::MarkFailures(const PipelineOutcome& outcome,
                                   Manifest* manifest) const {
  for (size_t i = 0; i < manifest->images.size(); ++i) {
    if (!outcome.failures[i]) {
      continue;
    }
    Manifest::Entry& entry = manifest->images[i];
    entry.note = FailureText(outcome.failures[i]);
    if (WasRefinedBefore(run_.catalogue, i)) {
      // It was only to be observed, and its maps are as good as before.
      entry.note = "cannot be observed for other images: " + entry.note;
    } else {
      entry.status = ImageStatus::kFailed;
    }
  }
}

}  // namespace tsar
