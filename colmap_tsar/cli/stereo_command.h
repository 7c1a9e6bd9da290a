// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/tools/stereo/stereo_workspace.h"

#include <filesystem>

namespace tsar {

// The arguments of tsar_stereo, from the command line or from Python.
struct StereoCommand {
  std::filesystem::path workspace_path;
  StereoImageFiles files;
  bool overwrite = false;
  DeviceOptions devices;
  StereoOptions stereo;

  void AddTo(OptionSet* options);

  // Throws kBadOption, and what MatchWorkspace throws.
  StereoSummary Run(Progress& progress) const;
};

}  // namespace tsar
