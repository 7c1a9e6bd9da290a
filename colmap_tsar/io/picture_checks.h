// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// Checks of files before OpenCV decodes them, which silently ignores damage and
// allocates whatever memory a header asks for.

// Checks the header of an OpenEXR file: the declared size must not be beyond
// what the file can hold, where a pixel takes at least 1/2048 byte. Throws
// Error kCorrupt. name: the file, for messages.
void CheckExr(std::span<const uint8_t> bytes, const std::string& name);

// The defect of the strips or tiles of a TIFF file's first picture, or empty.
// All of them are decoded.
//
// Truncated pixels are always found, damage only as far as the compression
// allows: Deflate by its checksum, others if the decoder fails, never in
// uncompressed data.
std::string FindTiffDefect(std::span<const uint8_t> bytes);

}  // namespace tsar
