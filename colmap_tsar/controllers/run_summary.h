// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/shard.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace tsar {

// What became of one image of a run.
struct ImageReport {
  enum class Outcome {
    kNotDone,  // The user asked to stop or there was an error: as it was.
    kRefined,
    kSkipped,  // Had been refined so before, and nothing has changed since.
    kKept,     // Keeps its maps; the reason says why.
  };
  Outcome outcome = Outcome::kNotDone;
  std::string reason;
  int num_sources_without_maps = 0;
  // Of refined images, as in their records: "pixels", "depth_before",
  // "depth_after", "not_finite" and one for each provenance.
  std::map<std::string, int64_t> counts;
  std::map<std::string, double> seconds;  // Per stage.
};

// What a run of RefineWorkspace did.
struct RunSummary {
  struct KeptImage {
    std::string name;
    std::string reason;
  };
  struct GpuMemory {
    std::string gpu;
    size_t num_bytes = 0;  // The most that was held at a time.
  };

  std::filesystem::path workspace_path;  // The one that was written.
  RefinePass pass = RefinePass::kAll;
  Shard shard;
  MapType type = MapType::kGeometric;
  std::string device;
  int num_workers = 0;  // Images at a time.
  int num_images = 0;
  int num_observed = 0;  // Only in a pass that does nothing else.
  int num_refined = 0;
  int num_skipped = 0;
  std::vector<KeptImage> kept;  // In the order of patch-match.cfg.
  int64_t num_sources_without_maps = 0;
  std::map<std::string, int64_t> counts;  // Sums over the refined images.
  std::map<std::string, double> seconds;
  double wall_seconds = 0.0;
  std::vector<GpuMemory> peak_gpu_memory;

  void Add(const std::string& image, const ImageReport& report);
};

// For the user: what was done, what it brought, how long it took, and the
// command to run next.
void PrintSummary(const RunSummary& summary, std::ostream& out);

}  // namespace tsar
