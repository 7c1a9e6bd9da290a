// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/import/formats/float_map.h"

#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// Reads a .dmb file of the family of Gipuma (ACMH, ACMM, ACMP, ACMMP): int32
// type (1 = float), height, width, channels; then float32 row by row, the
// channels of a pixel side by side. Depth is z in the camera frame, one
// channel; normals have three, in the world frame. Pixels have integer
// coordinates and K is used as it is, as in COLMAP's dense stage.
//
// name: the file, for messages. Throws Error kCorrupt where the header is not
// of this form or the length is not exactly what it says.
FloatMap ParseDmb(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace tsar
