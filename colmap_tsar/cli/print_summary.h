// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/run_summary.h"

#include <ostream>

namespace tsar {

// For the user: what was done, what it brought, how long it took, and the
// command to run next.
void PrintSummary(const RunSummary& summary, std::ostream& out);

}  // namespace tsar
