// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace tsar {

// What became of one image of a run.
struct ImageReport {
  enum class Outcome {
    kNotDone,  // The user asked to stop or there was an error: as it was.
    kDone,
    kSkipped,    // Had been done so before, and nothing has changed since.
    kNotListed,  // Stays as it is, since it is not to be refined.
    kKept,       // Keeps its maps; the reason says why.
  };
  Outcome outcome = Outcome::kNotDone;
  std::string reason;
  int num_sources_without_maps = 0;
  // Counts of refined images, as in their records: "pixels", "depth_before",
  // "depth_after", "not_finite" and one for each provenance.
  std::map<std::string, int64_t> counts;
  std::map<std::string, double> seconds;  // Per stage.
};

}  // namespace tsar
