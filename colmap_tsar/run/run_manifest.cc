// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/run_manifest.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/run/store/write_back.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace tsar {
namespace {

// The runtime settings of a run, by name; no result depends on them.
std::map<std::string, std::string> RuntimeText(const DeviceOptions& options,
                                               const PipelineDevices& devices) {
  TextStream cache_size;
  cache_size << options.cache_size;
  std::map<std::string, std::string> text = {
      {"device", ToString(options.choice)},
      {"gpu_index", GpuIndicesText(options.gpu_indices)},
      {"num_threads", std::to_string(options.num_threads)},
      {"cache_size", cache_size.str()},
      {"used", devices.description},
      {"images_at_a_time", std::to_string(devices.workers.size())}};
  for (const RunSummary::GpuMemory& peak : PeakGpuMemory(devices)) {
    text["peak_bytes of " + peak.gpu] = std::to_string(peak.num_bytes);
  }
  return text;
}

// Throws the first failure or, where images are left to be done, kInterrupted
// with the number of images done, out of num_wanted.
void RequireComplete(const PipelineOutcome& outcome, size_t num_wanted) {
  outcome.RethrowFailure();
  if (!outcome.IsComplete()) {
    const std::string done =
        outcome.num_observed
            ? std::to_string(*outcome.num_observed) + " of " +
                  std::to_string(outcome.reports.size()) +
                  " images were observed, before the first was refined"
            : std::to_string(outcome.NumDone()) + " of " +
                  std::to_string(num_wanted) + " images";
    throw Error(
        ErrorCode::kInterrupted,
        "interrupted after " + done + "; run the same command again to go on");
  }
}

Manifest Build(const RefineRun& run) {
  Manifest manifest =
      BuildManifest(run.workspace, run.refine_options, run.inputs.States());
  manifest.runtime.merge(RuntimeText(run.options.devices, run.devices));
  if (!run.options.image_list_path.empty()) {
    manifest.runtime["listed_images"] =
        std::to_string(run.selection.NumListed());
  }
  return manifest;
}

// Removes what only an unfinished run needs. The evidence may also be that of a
// run with other options.
void Finish(const Workspace& workspace, const RefineOptions& options) {
  EvidenceStore::Clear(workspace);
  const ContainedPath model = GetSceneModelPath(workspace.Root());
  if (NeedsEvidence(options)) {
    DropSceneLabels(model);
  } else {
    RemoveFile(model);
  }
}

void MarkFailures(const RefineRun& run,
                  const PipelineOutcome& outcome,
                  Manifest* manifest) {
  for (size_t i = 0; i < manifest->images.size(); ++i) {
    if (!outcome.failures[i]) {
      continue;
    }
    ImageRecord& entry = manifest->images[i];
    entry.note = FailureText(outcome.failures[i]);
    if (run.selection.HasBeenRefined(i)) {
      // The image was only to be observed, and its maps are as valid as before.
      entry.note = "cannot be observed for other images: " + entry.note;
    } else {
      entry.status = ImageStatus::kFailed;
    }
  }
}

// Throws where an image that can be refined has not been, as it is now.
void RequireAllDone(const Workspace& workspace,
                    const Manifest& manifest,
                    const ImageRecord& expected) {
  std::string first;
  size_t num_missing = 0;
  for (size_t i = 0; i < manifest.images.size(); ++i) {
    const int image = workspace.Problems()[i].reference;
    if (manifest.images[i].status != ImageStatus::kKept &&
        !IsDone(workspace, image, expected)) {
      first = num_missing++ == 0 ? manifest.images[i].image : first;
    }
  }
  if (num_missing > 0) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.Root().string(),
        std::to_string(num_missing) + " of " +
            std::to_string(manifest.images.size()) +
            " images have not been refined with these options from what is "
            "there now, the first of them " +
            first,
        "run " + OptionName("pass") +
            " observe of all shards, model, and compose of all shards; what "
            "is done is skipped");
  }
}

}  // namespace

void BeginManifest(const RefineRun& run) {
  if (run.options.pass == RefinePass::kAll) {
    WriteManifest(run.workspace, Build(run));
  }
}

void FinishManifest(const RefineRun& run, const PipelineOutcome& outcome) {
  if (run.options.pass != RefinePass::kAll) {
    RequireComplete(outcome, run.images.size());
    return;
  }
  Manifest manifest = Build(run);
  MarkFailures(run, outcome, &manifest);
  try {
    WriteManifest(run.workspace, manifest);
  } catch (const Error&) {
    // On a full disk the failure of the image is the more helpful message.
    outcome.RethrowFailure();
    throw;
  }
  RequireComplete(outcome, run.selection.NumListed());
  Finish(run.workspace, run.refine_options);
}

RunSummary SummarizeInputs(const Workspace& workspace,
                           RefinePass pass,
                           const std::vector<int>& references) {
  RunSummary summary;
  summary.workspace_path = workspace.Root();
  summary.model_folder = workspace.ModelFolder();
  summary.type = workspace.Type();
  summary.pass = pass;
  summary.num_images = static_cast<int>(references.size());
  summary.num_masks = workspace.CountMasks(references);
  summary.num_priors = workspace.Priors().Count(references);
  return summary;
}

RunSummary MergeShards(const WorkspaceRefineOptions& options,
                       const RefineOptions& refine_options) {
  const Stopwatch stopwatch;
  const Workspace workspace = OpenWorkspace(options);
  const WorkspaceLock lock(workspace.Root());
  const InputFingerprints inputs(workspace);
  const Manifest manifest =
      BuildManifest(workspace, refine_options, inputs.States());
  RequireAllDone(
      workspace, manifest, CurrentRecord(workspace, refine_options, inputs));
  WriteManifest(workspace, manifest);
  Finish(workspace, refine_options);

  RunSummary summary =
      SummarizeInputs(workspace, RefinePass::kMerge, workspace.References());
  summary.num_refined = manifest.NumImages(ImageStatus::kDone);
  for (const ImageRecord& record : manifest.images) {
    if (record.status == ImageStatus::kKept) {
      summary.kept.push_back({record.image, record.note});
    }
  }
  summary.counts = manifest.counts;
  summary.seconds = manifest.seconds;
  summary.wall_seconds = stopwatch.Seconds();
  return summary;
}

}  // namespace tsar
