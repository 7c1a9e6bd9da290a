// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/import_command.h"
#include "colmap_tsar/cli/interruption.h"
#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/restore_options.h"
#include "colmap_tsar/import/import_workspace.h"
#include "colmap_tsar/import/undo_import.h"
#include "colmap_tsar/store/workspace_lock.h"

#include <iostream>

#include <unistd.h>

namespace tsar {
namespace {

constexpr const char* kSummary =
    "Brings depth and normal maps of other programs and sensors into a dense "
    "workspace, so that tsar_refine and stereo_fusion can use them: maps of "
    "ACMH, ACMM, ACMP, ACMMP and Gipuma (acm), of APD (apd), of OpenMVS "
    "(openmvs), and depth images of any origin (depth). The workspace needs "
    "images/ and a sparse model in sparse/; the maps must have been made from "
    "both. Everything is checked before the first file is written. Maps that "
    "were there are kept in stereo/tsar_import, and --restore 1 puts them "
    "back.";

int UndoImports(const ImportCommand& command) {
  if (!command.input_path.empty() || !command.format.empty()) {
    throw Error(
        ErrorCode::kBadOption,
        "--restore undoes imports; leave --input_path and --format out");
  }
  const WorkspaceLock lock(command.workspace_path);
  const UndoResult result = UndoImport(
      command.workspace_path, ParseRestoreConflicts(command.restore_conflicts));
  std::cout << "Undid the import of " << result.num_images
            << (result.num_images == 1 ? " image" : " images") << ".\n";
  ReportRestored(result.kept, result.superseded, result.conflicts);
  return 0;
}

}  // namespace

int RunTsarImport(int argc, char** argv) {
  ImportCommand command;
  OptionSet options("tsar_import",
                    kSummary,
                    "tsar_import --format acm --input_path scene "
                    "--workspace_path dense");
  command.AddTo(&options);
  if (!options.Parse(argc, argv)) {
    return 0;
  }
  if (command.restore) {
    return UndoImports(command);
  }
  const ImportOptions import = command.Parse();
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  const Interruption interruption;
  PrintSummary(ImportWorkspace(
                   import, progress, [&] { return interruption.Requested(); }),
               std::cout);
  return 0;
}

}  // namespace tsar
