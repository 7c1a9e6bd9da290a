// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tsar {

// How one way of finding a pixel's depth is shown.
struct ProvenanceKind {
  std::string name;
  Rgb color;
};

// Indexed by the values of provenance maps; 0 is "none".
const std::vector<ProvenanceKind>& ProvenanceKinds();

// Throws Error kCorrupt for a value that is none of ProvenanceKinds().
Image<Rgb> ColorizeProvenance(const Image<uint8_t>& provenance);

}  // namespace tsar
