// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/tools/import/import_workspace.h"

#include <string>

namespace tsar {

// The arguments of tsar_import, from the command line or from Python.
struct ImportCommand {
  std::string workspace_path;
  std::string input_path;
  std::string format;
  std::string normal_path;
  std::string output_type = ToString(MapType::kGeometric);
  std::string index_order = "image_id";
  std::string image_list;
  std::string normal_frame = "auto";
  bool restore = false;
  std::string restore_conflicts = "report";
  // Options that the members above do not hold.
  ImportOptions import;

  void AddTo(OptionSet* options);

  // The import to do, unless it is to be undone. Throws kBadOption where
  // something is missing or does not fit the format.
  ImportOptions Parse() const;
};

}  // namespace tsar
