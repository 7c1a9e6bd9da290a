// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/refine_run.h"

namespace tsar {

// The second pass: finds the planes of the scene in the evidence of all views
// that have any, labels the views, and writes stereo/tsar/planes.bin. Returns
// false, without writing, where the user asked to stop.
bool ModelWorkspace(const RefineRun& run);

}  // namespace tsar
