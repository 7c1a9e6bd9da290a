// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace tsar {

// Fuses the maps of a workspace, or those before refinement (originals), into a
// cloud: a PLY file, perhaps with files whose names begin with its own.
using FuseMaps = std::function<void(const Workspace& workspace,
                                    bool originals,
                                    const std::filesystem::path& cloud,
                                    Progress& progress,
                                    const std::function<bool()>& should_stop)>;

struct PageOptions {
  std::filesystem::path report_path;
  bool overwrite = false;  // An earlier page alone may be replaced.
  // Fused clouds (PLY) for the 3D view. Where one is not given, fuse makes it
  // for the page; without fuse, its points are sampled from the maps.
  std::filesystem::path before_path;
  std::filesystem::path after_path;
  FuseMaps fuse;
  std::string fusion;  // How fuse works, for the reader.
  // Ground truth of depth maps, see DepthEvaluationOptions, and laser scans for
  // the clouds, see EvaluateCloudFile. Empty: no scores.
  std::filesystem::path ground_truth_path;
  std::filesystem::path scans_path;
  std::vector<double> tolerances = {0.02, 0.1};
  int max_picture_size = 1000;      // Longer side, in pixels.
  int64_t max_num_points = 300000;  // For each of before and after.
  int num_threads = -1;             // -1: one for each core.
};

// Writes the page of a refined workspace: a folder with index.html for
// browsers. It appears only when complete. Returns the number of images.
//
// Throws Error: kNotFound (nothing was refined), kBadOption (a cloud before without one after; scans without
// clouds; nothing to fuse), kInterrupted once should_stop returned true, and
// those of RequireOutsideInputs, WorkspaceLock (shared: a program is changing
// the workspace), OutputFolder, WriteImagePage, SampleCloud, ExportPlanes, fuse
// and the evaluations.
int WritePage(const Workspace& workspace,
              const PageOptions& options,
              Progress& progress,
              const std::function<bool()>& should_stop);

}  // namespace tsar
