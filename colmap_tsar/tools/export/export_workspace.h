// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/export/export_format.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

namespace tsar {

struct ExportOptions {
  static constexpr double kDefaultDepthScale = 0.001;

  ExportFormat format = ExportFormat::kNpy;
  std::filesystem::path output_path;
  // The folder with the masks of images, see io/image_masks.h; empty:
  // none. Masked pixels are exported as if they had no depth.
  std::filesystem::path mask_path;
  // For kNerfstudio: a PLY file in the sparse model's world, or empty.
  std::filesystem::path cloud_path;
  bool overwrite = false;  // An earlier export alone may be replaced.
  // For kPng16: units of the sparse model per step of depth.
  double depth_scale = kDefaultDepthScale;
  int num_threads = -1;  // -1: one for each core.
};

struct ExportSummary {
  int num_images = 0;  // Exported images, and those of them
  int num_with_depth = 0;
  // The number of exported images with a mask; nullopt without masks.
  std::optional<int64_t> num_masks;
  int64_t num_pixels = 0;  // Pixels of their maps.
  int64_t num_depths = 0;
};

// Writes the maps of a dense workspace, refined or not, and a manifest.json to
// a new folder, which appears only when complete. The masks of the options are
// used instead of the workspace's.
//
// Throws Error: kNotFound (no image has maps, or none a depth), kBadOption (a
// depth_scale or cloud_path for another format), kInterrupted once should_stop
// returned true, and those of Workspace::UseMasks, RequireOutsideInputs,
// WorkspaceLock (shared: a program is changing the workspace), OutputFolder,
// the exporters and the readers of the maps.
ExportSummary ExportWorkspace(Workspace workspace,
                              const ExportOptions& options,
                              Progress& progress,
                              const std::function<bool()>& should_stop);

}  // namespace tsar
