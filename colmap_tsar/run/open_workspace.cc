// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/open_workspace.h"

#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/workspace_check.h"

namespace tsar {

namespace {

Workspace OpenMapsOf(const WorkspaceRefineOptions& options) {
  Workspace workspace(options.workspace_path,
                      options.input_type.value_or(MapType::kGeometric));
  if (!options.input_type && !HasAnyMap(workspace, MapType::kGeometric) &&
      HasAnyMap(workspace, MapType::kPhotometric)) {
    Warn(options.workspace_path.string() +
         ": there are no geometric maps; refining the photometric ones");
    return Workspace(options.workspace_path, MapType::kPhotometric);
  }
  return workspace;
}

}  // namespace

Workspace OpenWorkspace(const WorkspaceRefineOptions& options) {
  Workspace workspace = OpenMapsOf(options);
  workspace.WarnOfSourcesLeftOut();
  workspace.UseMasks(options.mask_path);
  workspace.UsePriors(options.prior_path, options.prior_type);
  workspace.Priors().WarnOfStrayFiles();
  workspace.UseLabelImages(options.region_path);
  return workspace;
}

}  // namespace tsar
