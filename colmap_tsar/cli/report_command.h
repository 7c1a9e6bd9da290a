// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/tools/report/write_page.h"

#include <filesystem>
#include <optional>

namespace tsar {

// What tsar_report wrote.
struct ReportSummary {
  std::filesystem::path page_path;
  int num_images = 0;
};

// The arguments of tsar_report, from the command line or from Python.
struct ReportCommand {
  std::filesystem::path workspace_path;
  std::optional<MapType> input_type;
  PageOptions page;

  void AddTo(OptionSet* options);

  // Throws what Workspace and WritePage throw.
  ReportSummary Run(Progress& progress) const;
};

}  // namespace tsar
