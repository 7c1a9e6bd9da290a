// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/tools/export/export_workspace.h"

#include <filesystem>
#include <functional>
#include <string>

namespace tsar {

// The arguments of tsar_export, from the command line or from Python.
struct ExportCommand {
  std::filesystem::path workspace_path;
  std::string format;
  std::string input_type;
  // The options that the members above do not hold.
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
