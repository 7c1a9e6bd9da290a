// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/observe_task.h"

#include "colmap_tsar/base/image_name_hash.h"
#include "colmap_tsar/pipeline/refine_scene.h"

#include <utility>

namespace tsar {

ImageReport ObserveTask::Begin(size_t index) {
  ImageReport report;
  if (images_.CanRefine(index)) {
    images_.WarnOfChanges(index);
  }
  // What keeps an image from being refined is found out, and reported, in the
  // second pass.
  if (!images_.IsNeeded(index) ||
      (images_.ReusesResults() &&
       evidence_.IsCurrent(images_.Reference(index))) ||
      !images_.CanRefine(index)) {
    report.outcome = ImageReport::Outcome::kSkipped;
  }
  return report;
}

RefineResult ObserveTask::Compute(size_t index,
                                  size_t worker,
                                  ViewCache::Lease* views,
                                  ImageReport* /*report*/) {
  const int image = images_.Reference(index);
  const ViewData& reference = views->Get(image);
  if (!HasDepth(reference.depth)) {
    return {};
  }
  return RunSingleView(index,
                       worker,
                       views,
                       [&](std::vector<DeviceViewCache::View> sources,
                           Device& device,
                           StageObserver* observer) {
                         return MeasureImage(reference,
                                             std::move(sources),
                                             HashImageName(images_.Name(image)),
                                             options_,
                                             device,
                                             observer);
                       });
}

void ObserveTask::Write(size_t index,
                        RefineResult result,
                        ImageReport* report) {
  if (result.measured) {
    try {
      MakeEvidence(options_, *Device::CreateCpu(1), &result);
    } catch (const Error& error) {
      throw WithPlace(error, index, "the CPU");
    }
    evidence_.Write(images_.Reference(index), *result.evidence);
  }
  images_.AddSeconds(index, report->seconds);
  images_.AddSeconds(index, result.seconds);
  report->outcome = ImageReport::Outcome::kDone;
}

}  // namespace tsar
