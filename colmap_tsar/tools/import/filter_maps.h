// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/store/workspace.h"

namespace tsar {

// Writes, for each image with photometric maps, geometric ones: those depths
// that enough sources confirm (see FilterHypotheses), and their normals.
// Programs that fill textureless walls from a prior or by chance leave no
// holes, and neighboring views agree on what they fill in.
//
// Throws kInterrupted where the user asked to stop, and the errors of
// CheckWorkspace, OpenPipelineDevices and the readers and writers of maps.
// workspace: of the photometric type.
void FilterMaps(const Workspace& workspace,
                const DeviceOptions& device_options,
                Progress& progress);

}  // namespace tsar
