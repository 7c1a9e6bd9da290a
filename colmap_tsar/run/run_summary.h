// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/pipeline_outcome.h"
#include "colmap_tsar/run/shard.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// The settings and results of a run of RefineWorkspace.
struct RunSummary {
  struct KeptImage {
    std::string name;
    std::string reason;
  };
  struct GpuMemory {
    std::string gpu;
    size_t num_bytes = 0;  // The peak.
  };

  std::filesystem::path workspace_path;  // The one that was written.
  std::filesystem::path model_folder;    // The folder of its sparse model.
  // The obstacles to its fusion by COLMAP, see fusion_obstacles.h.
  std::vector<std::string> fusion_obstacles;
  RefinePass pass = RefinePass::kAll;
  Shard shard;
  MapType type = MapType::kGeometric;
  std::string device;
  int num_workers = 0;  // Images at a time.
  int num_images = 0;
  int num_observed = 0;  // Only in a pass that does nothing else.
  int num_refined = 0;
  int num_skipped = 0;
  int num_not_listed = 0;
  // The number of images with a mask; nothing where no masks were given.
  std::optional<int64_t> num_masks;
  // The number of images with a depth prior; nothing without priors.
  std::optional<int64_t> num_priors;
  std::vector<KeptImage> kept;  // In the order of patch-match.cfg.
  int64_t num_sources_without_maps = 0;
  std::map<std::string, int64_t>
      counts;  // Sums over all refined images, also of earlier runs.
  std::map<std::string, double> seconds;
  double wall_seconds = 0.0;
  std::vector<GpuMemory> peak_gpu_memory;

  void Add(const std::string& image, const ImageReport& report);

  // Whether all images that were to be refined were kept as they were; only
  // after a complete run, or once its shards were merged.
  bool RefinedNone() const {
    return (pass == RefinePass::kAll || pass == RefinePass::kMerge) &&
           num_refined == 0 && num_skipped == 0 && !kept.empty();
  }
};

}  // namespace tsar
