// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/shard.h"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// Names of counts in ImageReport.
inline constexpr const char* kPriorsUsed = "priors_used";
inline constexpr const char* kPriorsDropped = "priors_dropped";
inline constexpr const char* kBlackBorders = "black_borders";
inline constexpr const char* kMaskedAway = "masked_away";

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
  // Counts of images that are refined, or were before, as in their records:
  // "pixels", "depth_before", "depth_after", "not_finite", one for each
  // provenance, kPriorsUsed or kPriorsDropped (1) where the image has a depth
  // prior, kBlackBorders (1) where it has a black border and no mask, and
  // kMaskedAway (1) where all of its depths are masked.
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
  // The obstacles to its fusion by COLMAP, see FindFusionObstacles().
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
  // Sums over all refined images, also of earlier runs.
  std::map<std::string, int64_t> counts;
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
