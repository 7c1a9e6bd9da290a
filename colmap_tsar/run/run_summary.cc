// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/run_summary.h"

#include <algorithm>

namespace tsar {

int PipelineOutcome::NumDone() const {
  return static_cast<int>(
      std::ranges::count_if(reports, [](const ImageReport& report) {
        return report.outcome != ImageReport::Outcome::kNotDone &&
               report.outcome != ImageReport::Outcome::kNotListed;
      }));
}

bool PipelineOutcome::IsComplete() const {
  return std::ranges::find(reports,
                           ImageReport::Outcome::kNotDone,
                           &ImageReport::outcome) == reports.end();
}

void PipelineOutcome::RethrowFailure() const {
  if (first_failure) {
    std::rethrow_exception(first_failure);
  }
}

void RunSummary::Add(const std::string& image, const ImageReport& report) {
  num_sources_without_maps += report.num_sources_without_maps;
  switch (report.outcome) {
    case ImageReport::Outcome::kDone:
      ++num_refined;
      break;
    case ImageReport::Outcome::kSkipped:
      ++num_skipped;
      break;
    case ImageReport::Outcome::kNotListed:
      ++num_not_listed;
      break;
    case ImageReport::Outcome::kKept:
      kept.push_back({image, report.reason});
      break;
    case ImageReport::Outcome::kNotDone:
      break;
  }
  // A kept image only has the count of its values that are not finite.
  for (const auto& [name, count] : report.counts) {
    counts[name] += count;
  }
  if (report.outcome == ImageReport::Outcome::kDone) {
    for (const auto& [stage, value] : report.seconds) {
      seconds[stage] += value;
    }
  }
}

}  // namespace tsar
