// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/run/store/workspace.h"

#include <filesystem>

namespace tsar {

struct PageOptions {
  std::filesystem::path report_path;
  bool overwrite = false;       // An earlier page alone may be replaced.
  int max_picture_size = 1000;  // Longer side, in pixels.
  int num_threads = -1;         // -1: one for each core.
};

// Writes the page of a refined workspace: a folder with index.html for
// browsers. It appears only when complete. Returns the number of images.
//
// Throws Error: kNotFound (nothing was refined), kInterrupted where the user
// asked to stop, and those of RequireOutsideInputs, WorkspaceLock (shared: a
// program is changing the workspace), OutputFolder and WriteImagePage.
int WritePage(const Workspace& workspace,
              const PageOptions& options,
              Progress& progress);

}  // namespace tsar
