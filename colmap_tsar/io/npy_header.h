// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <bit>
#include <cstddef>
#include <string>

namespace tsar {

static_assert(std::endian::native == std::endian::little,
              "arrays are little-endian and written as they are");

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
