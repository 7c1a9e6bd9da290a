// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// The defect of the strips or tiles of a TIFF file's first picture, or empty.
// All of them are decoded, since OpenCV silently ignores failures.
//
// Truncated pixels are always found, damage only as far as the compression
// allows: Deflate by its checksum, others if the decoder fails, never in
// uncompressed data.
std::string FindTiffDefect(std::span<const uint8_t> bytes);

}  // namespace tsar
