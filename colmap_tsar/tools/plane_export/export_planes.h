// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/plane_export/exported_planes.h"

#include <functional>

namespace tsar {

struct PlaneExportOptions {
  // The least area of a plane, in square units of the sparse model.
  double min_area = 0.0;
};

// Whether a workspace has a file of scene planes and plane maps; those refined
// without scene planes have none.
bool HasPlanes(const Workspace& workspace);

// The planes of a refined workspace, from its stereo/tsar/planes.bin, with
// their visible parts in the refined maps of its type. Holds the maps of one
// image at a time and reads them twice. is_stopped: called before each image.
//
// Throws Error: kNotFound (HasPlanes() is false), kMismatch (maps, planes and
// model are not of one run), kInterrupted, and those of the readers.
ExportedPlanes ExportPlanes(const Workspace& workspace,
                            const PlaneExportOptions& options,
                            Progress& progress,
                            const std::function<bool()>& is_stopped);

}  // namespace tsar
