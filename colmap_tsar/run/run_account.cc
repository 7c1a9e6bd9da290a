// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/run_account.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/text_stream.h"
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

}  // namespace

void RunAccount::Begin() {
  if (!run_.IsShard()) {
    WriteManifest(run_.workspace, Build());
  }
}

void RunAccount::End(const PipelineOutcome& outcome) {
  if (run_.IsShard()) {
    RequireComplete(outcome, run_.Images().size());
    return;
  }
  Manifest manifest = Build();
  MarkFailures(outcome, &manifest);
  try {
    WriteManifest(run_.workspace, manifest);
  } catch (const Error&) {
    // On a full disk the failure of the image is the more helpful message.
    outcome.RethrowFailure();
    throw;
  }
  RequireComplete(outcome, run_.plan.NumListed());
  // The evidence may also be that of a run with other options.
  EvidenceStore::Clear(run_.workspace);
  if (run_.HasScenePlanes()) {
    SceneModelStore::DropLabels(run_.workspace);
  } else {
    SceneModelStore::Remove(run_.workspace);
  }
}

Manifest RunAccount::Build() const {
  Manifest manifest = BuildManifest(run_.workspace,
                                    RefineOptionsText(run_.refine_options),
                                    HashRefineOptions(run_.refine_options));
  manifest.runtime = RuntimeText(run_.options.devices, run_.devices);
  manifest.inputs = run_.inputs.States();
  if (!run_.options.image_list_path.empty()) {
    manifest.runtime["listed_images"] = std::to_string(run_.plan.NumListed());
  }
  NoteMasksAndPriors(run_.NumMasks(), run_.NumPriors(), &manifest);
  return manifest;
}

void RunAccount::MarkFailures(const PipelineOutcome& outcome,
                              Manifest* manifest) const {
  for (size_t i = 0; i < manifest->images.size(); ++i) {
    if (!outcome.failures[i]) {
      continue;
    }
    Manifest::Entry& entry = manifest->images[i];
    entry.note = FailureText(outcome.failures[i]);
    if (run_.plan.HasBeenRefined(i)) {
      // The image was only to be observed, and its maps are as valid as before.
      entry.note = "cannot be observed for other images: " + entry.note;
    } else {
      entry.status = ImageStatus::kFailed;
    }
  }
}

}  // namespace tsar
