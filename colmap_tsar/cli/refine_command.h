// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/run/refine_workspace.h"

#include <string>

namespace tsar {

// The arguments of tsar_refine, from the command line or from Python.
struct RefineCommand {
  bool restore = false;
  std::string preset = "default";
  WorkspaceRefineOptions workspace;
  RefineOptions refine;

  void AddTo(OptionSet* options);

  // Sets the options of the method to those of the preset. Options given by the
  // user override these, and have to be set again afterwards.
  void UsePreset();

  // Throws kBadOption, and what RefineWorkspace throws.
  RunSummary Run(Progress& progress) const;
};

// Throws kNotFound where no image could be refined, so that the next command
// would find no refined maps.
void RequireRefined(const RunSummary& summary);

}  // namespace tsar
