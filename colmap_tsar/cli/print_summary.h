// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/tools/import/import_summary.h"
#include "colmap_tsar/tools/stereo/stereo_workspace.h"

#include <cstdint>
#include <optional>
#include <ostream>
#include <vector>

namespace tsar {

// For the user: what was done, what it brought, how long it took, and the
// command to run next.
void PrintSummary(const RunSummary& summary, std::ostream& out);

// For how many of the images there are masks; nothing where none were given.
void PrintMasks(const std::optional<int64_t>& num_masks,
                int num_images,
                std::ostream& out);

// The most that each GPU held, a line each.
void PrintPeakMemory(const std::vector<RunSummary::GpuMemory>& peaks,
                     std::ostream& out);

// Where the maps were made, what has none, and the command to run next.
void PrintSummary(const StereoSummary& summary, std::ostream& out);

// A few lines for the user, with the next command to give. Of many warnings,
// the first ones.
void PrintSummary(const ImportSummary& summary, std::ostream& out);

}  // namespace tsar
