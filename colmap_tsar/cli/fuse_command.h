// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/fusion/fuse_workspace.h"

#include <filesystem>
#include <optional>
#include <string>

namespace tsar {

// The arguments of tsar_fuse, from the command line or from Python.
struct FuseCommand {
  std::filesystem::path workspace_path;
  std::optional<MapType> input_type;
  std::filesystem::path bounding_box_path;
  bool overwrite = false;
  std::string preset = "default";
  // All options that are not members above.
  FuseWorkspaceOptions options;

  void AddTo(OptionSet* set);

  // Sets the criteria to those of the preset. Options given by the user
  // override these, and have to be set again afterwards.
  void UsePreset();

  // Throws what RequireWritableOutput throws for the cloud and its visibility.
  void CheckOutput() const;

  // Throws kBadOption, and what RequireWritableOutput, OpenWorkspaceWithMaps,
  // ReadBoundingBox and FuseWorkspace throw.
  FuseSummary Run(Progress& progress) const;
};

}  // namespace tsar
