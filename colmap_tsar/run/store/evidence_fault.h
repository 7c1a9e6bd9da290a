// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/evidence_file.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <optional>
#include <string>

namespace tsar {

// The invariant of ViewEvidence that these parts violate, as the fault ("a
// label that no superpixel has"); nothing where they satisfy all.
std::optional<std::string> FindEvidenceFault(const ViewEvidence& evidence,
                                             EvidenceParts parts);

}  // namespace tsar
