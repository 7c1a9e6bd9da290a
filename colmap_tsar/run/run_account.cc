// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/run_account.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace tsar {
namespace {

// The runtime settings of a run, by name; no result depends on them.
std::map<std::string, std::string> RuntimeText(const DeviceOptions& options,
                                               const RefineDevices& devices) {
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
  Manifest manifest = BuildManifest(run.workspace,
                                    RefineOptionsText(run.refine_options),
                                    HashRefineOptions(run.refine_options));
  manifest.runtime = RuntimeText(run.options.devices, run.devices);
  manifest.inputs = run.inputs.States();
  if (!run.options.image_list_path.empty()) {
    manifest.runtime["listed_images"] = std::to_string(run.plan.NumListed());
  }
  NoteMasksAndPriors(run.NumMasks(), run.NumPriors(), &manifest);
  return manifest;
}

void MarkFailures(const RefineRun& run,
                  const PipelineOutcome& outcome,
                  Manifest* manifest) {
  for (size_t i = 0; i < manifest->images.size(); ++i) {
    if (!outcome.failures[i]) {
      continue;
    }
    Manifest::Entry& entry = manifest->images[i];
    entry.note = FailureText(outcome.failures[i]);
    if (run.plan.HasBeenRefined(i)) {
      // The image was only to be observed, and its maps are as valid as before.
      entry.note = "cannot be observed for other images: " + entry.note;
    } else {
      entry.status = ImageStatus::kFailed;
    }
  }
}

}  // namespace

void BeginAccount(const RefineRun& run) {
  if (!run.IsShard()) {
    WriteManifest(run.workspace, Build(run));
  }
}

void EndAccount(const RefineRun& run, const PipelineOutcome& outcome) {
  if (run.IsShard()) {
    RequireComplete(outcome, run.Images().size());
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
  RequireComplete(outcome, run.plan.NumListed());
  // The evidence may also be that of a run with other options.
  EvidenceStore::Clear(run.workspace);
  if (run.HasScenePlanes()) {
    SceneModelStore::DropLabels(run.workspace);
  } else {
    SceneModelStore::Remove(run.workspace);
  }
}

}  // namespace tsar
