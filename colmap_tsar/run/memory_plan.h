// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/view/refine_options.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

namespace tsar {

// Bytes of main memory of each pixel of a view: color, depth, normal and cost.
inline constexpr int64_t kViewBytesPerPixel = 23;

// The memory that an image at work takes, in bytes, for the largest map of the
// workspace and the image with most sources.
struct MemoryPlan {
  int num_sources = 0;  // The largest number.
  // Memory of the device that computes, with the uploaded sources; main memory
  // where that is the CPU.
  int64_t device = 0;
  // The part of `device` that only GPUs need: the CPU reads views in place.
  int64_t copies = 0;
  // Other main memory: its views, a photo that is read, the evidence of its
  // neighborhood, the result.
  int64_t main = 0;
  int64_t views = 0;  // The part of `main` that is for views.
  // Main memory of a block of views in which planes are found, and of a view
  // that is labeled with planes, in a pass in which nothing else is done; 0
  // unless images are refined together with their neighbors.
  int64_t model_block = 0;
  int64_t label_view = 0;
  // What the user can do where one image needs too much main memory.
  std::string advice =
      "run patch_match_stereo with fewer source images or a smaller "
      "--PatchMatchStereo.max_image_size";
};

// The factors were measured and are upper bounds; memory_plan_test.cc runs the
// stages on a device that counts.
MemoryPlan PlanRefinement(const RefineOptions& options,
                          const WorkspaceOverview& overview);

// Main memory to read a view and to write a result, besides the view.
int64_t ReadAndWriteBytes(const WorkspaceOverview& overview);

// The number of pixels of the largest view that is used together with its
// sources: reduced (ReduceView) where images are refined together with them.
int64_t NumJudgedPixels(const WorkspaceOverview& overview);

// The number of views whose evidence is kept in main memory: a neighborhood for
// each of these images at work, and one for the next images.
size_t NumEvidenceViews(const WorkspaceOverview& overview, int num_images);

// "1.3 GB", rounded up.
std::string Gigabytes(int64_t num_bytes);

// How often bytes_each fit into num_bytes: at least once, at most max times.
int NumThatFit(int64_t num_bytes, int64_t bytes_each, int max);

// The main memory that a run may take: cache_size (DeviceOptions), but at most
// four fifths of machine_bytes; the rest is for the system and its file cache.
int64_t MainMemoryBudget(double cache_size, int64_t machine_bytes);

// The numbers of images at a time.
struct ImagesAtWork {
  int num_threads = 1;  // Each of which reads, computes and writes one image.
  int num_workers = 1;  // Those that compute.
  int64_t view_bytes = 0;  // Main memory for views.

  // The number of views of this size that are kept.
  size_t MaxNumViews(int64_t num_pixels) const {
    return static_cast<size_t>(
        view_bytes / std::max<int64_t>(kViewBytesPerPixel * num_pixels, 1));
  }
};

// As many as fit into the budget, at most those of `wanted`. Warns if one image
// alone needs more than the budget. Throws kOutOfMemory where it needs more
// than machine_bytes. on_cpu: whether the CPU computes; else the number of
// workers stays.
ImagesAtWork FitIntoMainMemory(const MemoryPlan& plan,
                               const ImagesAtWork& wanted,
                               bool on_cpu,
                               double cache_size,
                               int64_t machine_bytes);

}  // namespace tsar
