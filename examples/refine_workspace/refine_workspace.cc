// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Refines a dense workspace from C++, as `colmap_tsar tsar_refine` does:
//
//   refine_workspace WORKSPACE OUTPUT

#include "colmap_tsar/run/refine_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/progress.h"

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: refine_workspace WORKSPACE OUTPUT\n";
    return 2;
  }
  tsar::WorkspaceRefineOptions workspace;
  workspace.workspace_path = argv[1];
  workspace.output_path = argv[2];  // Leave it out to refine in place.

  tsar::RefineOptions options;
  options.num_iterations = 3;

  tsar::Progress progress(std::cerr, /*live=*/false);
  try {
    const tsar::RunSummary summary =
        tsar::RefineWorkspace(workspace, options, progress);
    std::cout << summary.num_refined << " images refined\n";
  } catch (const tsar::Error& error) {
    std::cerr << "ERROR: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
