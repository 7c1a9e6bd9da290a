// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// Files about the images; empty paths: none.
struct StereoImageFiles {
  // A text file with the names of the images whose maps are made, identical to
  // those of a run on all images, which an empty path stands for. The
  // photometric maps of the images that they depend on are kept, too.
  std::filesystem::path image_list_path;
  // The folder with the masks of images, see io/image_masks.h. Masked
  // pixels get no depth, and those of sources confirm none.
  std::filesystem::path mask_path;
};

struct StereoSummary {
  std::filesystem::path workspace_path;
  // The type of maps for the next step.
  MapType type = MapType::kGeometric;
  std::string device;
  int num_images = 0;
  int num_skipped = 0;  // Images done before.
  // The number of images with a mask; nullopt without masks.
  std::optional<int64_t> num_masks;
  std::vector<RunSummary::KeptImage> without_sources;
  double wall_seconds = 0.0;
  std::vector<RunSummary::GpuMemory> peak_gpu_memory;
};

// Makes depth, normal and cost maps for all images of stereo/patch-match.cfg,
// photometric and, by default, geometric ones, in several passes over the
// images. Intermediate files are kept in stereo/tsar_stereo until the run ends.
// overwrite: whether to replace maps that this program did not make, or made
// with other options or inputs.
//
// Where all of them are done, also of a workspace that has been refined since,
// nothing is changed.
//
// Throws Error: kUnsupported (there are such maps and overwrite is false, or
// the workspace has been refined and maps are to be made), kNotFound (no image
// has sources; an image without sparse points needs options.depth_min and
// depth_max), kInterrupted where the user asked to stop, and those of the
// workspace, its lock, the devices, writing and Workspace::UseMasks. Completed
// images are kept; the same call resumes the run.
StereoSummary MatchWorkspace(const std::filesystem::path& workspace_path,
                             const DeviceOptions& device_options,
                             const StereoOptions& options,
                             bool overwrite,
                             Progress& progress,
                             const StereoImageFiles& files = {});

}  // namespace tsar
