// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// What is wrong with the strips or tiles of a TIFF file's first picture, or
// nothing. All of them are decoded for it, since OpenCV goes on in silence
// where one of them cannot be.
//
// A file that is cut off within the pixels is always noticed, damage between
// them only where the compression shows it: Deflate by its checksum, others
// where the decoder stumbles, data that are not compressed never.
std::string FindTiffDefect(std::span<const uint8_t> bytes);

}  // namespace tsar
