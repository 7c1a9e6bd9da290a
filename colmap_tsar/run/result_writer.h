// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/refine_run.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/view/refined_maps.h"

#include <string>

namespace tsar {

// Writes the results of images, given by their indices in the sparse model, and
// their records. Can be used from several threads for different images.
class ResultWriter {
 public:
  // run must outlive this object.
  explicit ResultWriter(const RefineRun& run);

  // Replaces the maps by the refined ones, without masked pixels, and records
  // the counts and times of the report.
  void Write(int image, RefinedMaps maps, ImageReport* report);
  // Keeps the original maps, and records the reason.
  void Keep(int image, const std::string& reason, ImageReport* report);

 private:
  const RefineRun& run_;
  const std::string options_hash_;
  const std::string planes_;  // As in RefinePlan.
};

}  // namespace tsar
