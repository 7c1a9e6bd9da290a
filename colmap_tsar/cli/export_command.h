// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/tools/export/export_workspace.h"

#include <functional>
#include <string>

namespace tsar {

// The arguments of tsar_export, from the command line or from Python.
struct ExportCommand {
  std::string workspace_path;
  std::string output_path;
  std::string format;
  std::string input_type;
  std::string mask_path;
  std::string cloud_path;
  // Without the format and the paths, which the members above hold.
  ExportOptions options;

  void AddTo(OptionSet* set);

  // Throws what OpenWorkspaceWithMaps, ParseExportFormat and ExportWorkspace
  // throw.
  ExportSummary Run(Progress& progress,
                    const std::function<bool()>& should_stop) const;

  // The command that trains on the folder; empty for other formats.
  std::string TrainingCommand() const;
};

}  // namespace tsar
