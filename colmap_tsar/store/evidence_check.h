// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/view_evidence.h"
#include "colmap_tsar/store/evidence_file.h"

#include <optional>
#include <string>

namespace tsar {

// Which promise of ViewEvidence these parts break, as what they have ("a label
// that no superpixel has"); nothing where they keep all.
std::optional<std::string> FindEvidenceFault(const ViewEvidence& evidence,
                                             EvidenceParts parts);

}  // namespace tsar
