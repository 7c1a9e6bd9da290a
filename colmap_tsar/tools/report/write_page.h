// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace tsar {

struct PageOptions {
  std::filesystem::path report_path;
  bool overwrite = false;  // An earlier page alone may be replaced.
  // The --TsarRefine.debug_path of the run that made the maps; may be empty.
  std::filesystem::path debug_path;
  // Fused clouds (PLY) for the 3D view, both or none; if none, its points are
  // sampled from the maps.
  std::filesystem::path before_path;
  std::filesystem::path after_path;
  // Ground truth of depth maps, see DepthEvaluationOptions, and laser scans for
  // the clouds, see EvaluateCloudFile. Empty: no scores.
  std::filesystem::path ground_truth_path;
  std::filesystem::path scans_path;
  std::vector<double> tolerances = {0.02, 0.1};
  int max_picture_size = 1000;      // Longer side, in pixels.
  int64_t max_num_points = 300000;  // For each of before and after.
  int num_threads = -1;             // -1: one for each core.
};

// Writes the page of a refined workspace: one folder with index.html, which a
// browser opens from the disk. The folder appears only when complete. Returns
// the number of images on the page.
//
// Throws Error: kNotFound (nothing was refined; no image has pictures in
// debug_path), kBadOption (one cloud without the other; scans without clouds),
// kInterrupted once should_stop returned true, and those of
// RequireOutsideInputs, WorkspaceLock (shared: a program is changing the
// workspace), OutputFolder, WriteImagePage, SampleCloud, ExportPlanes and the
// evaluations.
int WritePage(const Workspace& workspace,
              const PageOptions& options,
              Progress& progress,
              const std::function<bool()>& should_stop);

}  // namespace tsar
