// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/float_map.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// The readers take the bytes of a file and its name, for messages. They throw
// Error kCorrupt where the header is not of the described form or the length is
// not exactly what it says.

// Reads a portable float map: "Pf" (one channel) or "PF" (three), width,
// height, scale, each followed by white space, the last by one byte of it; then
// float32 from the bottom row up, little-endian where the scale is negative.
// The scale's magnitude is ignored, as all programs that write depth expect.
FloatMap ParsePfm(std::span<const uint8_t> bytes, const std::string& name);

struct NpyArray {
  FloatMap map;
  bool is_integer = false;  // Stored as uint16.
};

// Reads a NumPy array of shape (height, width) or (height, width, channels), of
// float16, float32, float64 or uint16 in either byte order, rows one after the
// other ("C order"). Versions 1 to 3 of the format.
// Throws Error kUnsupported for other types, shapes and Fortran order.
NpyArray ParseNpy(std::span<const uint8_t> bytes, const std::string& name);

// Size of the header in bytes.
inline constexpr size_t kNpyHeaderSize = 128;

// The header of an array in NumPy's format (.npy, version 1.0), whose values
// follow row by row: magic, version, the length of the text, and the text,
// padded so that the values begin at a multiple of 64 bytes.
//
// type: NumPy's notation, such as "<f4". shape: such as "480, 640".
inline std::string NpyHeader(const std::string& type,
                             const std::string& shape) {
  constexpr size_t kTextBegin = 10;
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(kNpyHeaderSize - kTextBegin);
  header += '\0';
  header += "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" +
            shape + "), }";
  header.resize(kNpyHeaderSize - 1, ' ');
  return header + '\n';
}

}  // namespace tsar
