// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/image_report.h"

#include <cstddef>
#include <exception>
#include <vector>

namespace tsar {

// What became of the images of one pass. An element for each, in their order.
struct PipelineOutcome {
  std::vector<ImageReport> reports;
  std::vector<std::exception_ptr> failures;  // Null where there was none.
  // The failure that came first in time, of which others may be consequences;
  // null where there was none.
  std::exception_ptr first_failure;

  explicit PipelineOutcome(size_t num_images = 0)
      : reports(num_images), failures(num_images) {}

  // Images that were to be refined, or observed, and are neither failed nor
  // left undone.
  int NumDone() const;
  // Whether no image is failed or left undone.
  bool IsComplete() const;
  // Throws the first failure, if there was one.
  void RethrowFailure() const;
};

}  // namespace tsar
