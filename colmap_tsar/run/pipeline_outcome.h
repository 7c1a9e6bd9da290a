// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/priors/align_prior.h"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// Names of counts in ImageReport.
inline constexpr const char* kPriorsUsed = "priors_used";
inline constexpr const char* kPriorsDropped = "priors_dropped";

// The outcome of one image of a run.
struct ImageReport {
  enum class Outcome {
    kNotDone,  // Unchanged: the user asked to stop, or there was an error.
    kDone,
    kSkipped,    // Done by an earlier run, and nothing has changed since.
    kNotListed,  // Stays as it is, since it is not to be refined.
    kKept,       // Keeps its maps; the reason says why.
  };
  Outcome outcome = Outcome::kNotDone;
  std::string reason;
  int num_sources_without_maps = 0;
  // The fit of the depth prior of a refined image.
  PriorAssessment prior;
  // Counts of images that are refined, or were before, as in their records:
  // "pixels", "depth_before", "depth_after", "not_finite", one for each
  // provenance, and kPriorsUsed or kPriorsDropped (1) where the image has a
  // depth prior.
  std::map<std::string, int64_t> counts;
  std::map<std::string, double> seconds;  // Per stage.
};

// The outcomes of the images of one pass, in their order.
struct PipelineOutcome {
  std::vector<ImageReport> reports;
  std::vector<std::exception_ptr> failures;  // Null where there was none.
  // The failure that came first in time, of which others may be consequences;
  // null where there was none.
  std::exception_ptr first_failure;
  // The number of observed images, where a run ended before the pass that
  // refines.
  std::optional<int> num_observed;

  explicit PipelineOutcome(size_t num_images = 0)
      : reports(num_images), failures(num_images) {}

  // The number of images to refine, or observe, that are neither failed nor
  // left undone.
  int NumDone() const;
  // Whether no image is failed or left undone.
  bool IsComplete() const;
  // Throws the first failure, if there was one.
  void RethrowFailure() const;
};

}  // namespace tsar
