// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/shared_options.h"
#include "colmap_tsar/fusion/fuse_workspace.h"

#include <filesystem>
#include <functional>
#include <string>

namespace tsar {

// The arguments of tsar_fuse, from the command line or from Python.
struct FuseCommand {
  std::filesystem::path workspace_path;
  std::string input_type;
  std::filesystem::path bounding_box_path;
  bool overwrite = false;
  std::string preset = "default";
  // -1: the value of the preset.
  int min_num_views = -1;
  double max_reproj_error = -1.0;
  double max_depth_error = -1.0;
  double max_normal_error = -1.0;
  int check_num_images = -1;
  int point_spacing = -1;
  DeviceArguments devices;
  // The options that the members above do not hold.
  FuseWorkspaceOptions options;

  void AddTo(OptionSet* set);

  // Throws kBadOption, and what RequireWritableOutput, OpenWorkspaceWithMaps,
  // ReadBoundingBox and FuseWorkspace throw.
  FuseSummary Run(Progress& progress,
                  const std::function<bool()>& should_stop) const;

 private:
  FusionOptions Fusion() const;
};

}  // namespace tsar
