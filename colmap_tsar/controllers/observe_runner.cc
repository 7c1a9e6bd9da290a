// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/observe_runner.h"

#include <utility>

namespace tsar {

ObserveRunner::ObserveRunner(ImageRunner& images, EvidenceStore& evidence)
    : images_(images), evidence_(evidence) {}

ImageReport ObserveRunner::Begin(size_t index) {
  ImageReport report;
  if (images_.CanCompute(index)) {
    images_.WarnOfChanges(index);
  }
  // What keeps an image from being refined is found out, and reported, in the
  // second pass.
  if (!images_.IsNeeded(index) ||
      (images_.ReusesResults() &&
       evidence_.IsCurrent(images_.Reference(index))) ||
      !images_.CanCompute(index)) {
    report.outcome = ImageReport::Outcome::kSkipped;
  }
  return report;
}

RefineResult ObserveRunner::Compute(size_t index,
                                    size_t worker,
                                    ViewCache::Lease* views,
                                    ImageReport* /*report*/) {
  return images_.Observe(index, worker, views);
}

void ObserveRunner::Write(size_t index,
                          RefineResult result,
                          ImageReport* report) {
  if (result.measured) {
    images_.MakeEvidenceOf(index, &result);
    evidence_.Write(images_.Reference(index), *result.evidence);
  }
  images_.AddSeconds(index, report->seconds);
  images_.AddSeconds(index, result.seconds);
  report->outcome = ImageReport::Outcome::kRefined;
}

}  // namespace tsar
