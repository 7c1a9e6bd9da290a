// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/import/formats/float_map.h"

#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// Reads a .dmb or .bin file of APD and its successors: an OpenCV matrix as
// int32 version, rows, columns, OpenCV type (5 = one float, 21 = three), then
// the rows. Some versions leave the first word out; which it is, the file's
// length tells. Depth and normals are as in ParseDmb.
//
// name: the file, for messages. Throws Error kCorrupt where neither form, or
// both, have exactly the file's length, or the matrix is not of floats.
FloatMap ParseApdMap(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace tsar
