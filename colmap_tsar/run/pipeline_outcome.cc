// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/pipeline_outcome.h"

#include <algorithm>

namespace tsar {

int PipelineOutcome::NumDone() const {
  return static_cast<int>(std::count_if(
      reports.begin(), reports.end(), [](const ImageReport& report) {
        return report.outcome != ImageReport::Outcome::kNotDone &&
               report.outcome != ImageReport::Outcome::kNotListed;
      }));
}

bool PipelineOutcome::IsComplete() const {
  return std::none_of(
      reports.begin(), reports.end(), [](const ImageReport& report) {
        return report.outcome == ImageReport::Outcome::kNotDone;
      });
}

void PipelineOutcome::RethrowFailure() const {
  if (first_failure) {
    std::rethrow_exception(first_failure);
  }
}

}  // namespace tsar
