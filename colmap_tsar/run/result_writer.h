// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/refined_maps.h"

#include <string>

namespace tsar {

// For images, given by their indices in the sparse model, from several threads
// for different ones.

// Replaces the maps by the refined ones, without masked pixels, and records the
// counts and times of the report. record: see CurrentRecord.
void WriteResult(const Workspace& workspace,
                 int image,
                 RefinedMaps maps,
                 ImageRecord record,
                 ImageReport* report);

// Keeps the original maps, and records the reason.
void KeepOriginals(const Workspace& workspace,
                   int image,
                   const std::string& reason,
                   const std::string& options_hash,
                   ImageReport* report);

}  // namespace tsar
