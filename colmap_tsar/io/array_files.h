// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/float_map.h"

#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// Reads a portable float map: "Pf" (one channel) or "PF" (three), width,
// height, scale, each followed by white space, the last by one byte of it; then
// float32 from the bottom row up, little-endian where the scale is negative.
// The scale's magnitude is ignored, as all programs that write depth expect.
//
// name: the file, for messages. Throws Error kCorrupt where the header is not
// of this form or the length is not exactly what it says.
FloatMap ParsePfm(std::span<const uint8_t> bytes, const std::string& name);

struct NpyArray {
  FloatMap map;
  bool is_integer = false;  // Stored as uint16.
};

// Reads a NumPy array of shape (height, width) or (height, width, channels), of
// float16, float32, float64 or uint16 in either byte order, rows one after the
// other ("C order"). Versions 1 to 3 of the format.
//
// name: the file, for messages. Throws Error: kCorrupt where the header is not
// of this form or the length is not exactly what it says, kUnsupported for
// other types, shapes and Fortran order.
NpyArray ParseNpy(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace tsar
