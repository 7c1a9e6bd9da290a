// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/observe_task.h"

#include "colmap_tsar/pipeline/refine_scene.h"

namespace tsar {

ImageReport ObserveTask::Begin(size_t index) {
  ImageReport report;
  if (images_.CanRefine(index)) {
    images_.WarnOfChanges(index);
  }
  // What keeps an image from being refined is found out, and reported, in the
  // second pass.
  if (!(has_model_ ? images_.IsNeeded(index) : images_.IsAnyNeeded()) ||
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
  if (!HasDepth(views->Get(images_.Reference(index)).depth)) {
    return {};
  }
  return RunSingleView(index, worker, views, &MeasureImage);
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
