// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/tools/import/import_workspace.h"

#include <string>

namespace tsar {

// The arguments of tsar_import, from the command line or from Python.
struct ImportCommand {
  std::string format;
  ImportOptions options;

  void AddTo(OptionSet* set);

  // Throws kBadOption if an option does not apply to the format, and what
  // ImportWorkspace throws.
  ImportSummary Run(Progress& progress) const;
};

}  // namespace tsar
