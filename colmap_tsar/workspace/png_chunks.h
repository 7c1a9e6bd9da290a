// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/workspace/png_pixels.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tsar {

// PNG as a sequence of chunks, of which each has a checksum. libpng would
// notice damage as well, but prints it on the standard error in its own words.

// What is wrong with the bytes of a PNG file, or nothing: that they break off,
// that the checksum of a chunk is wrong which is needed for the pixels, or that
// such chunks do not hold what they should. Decompresses the pixels.
std::string FindPngDefect(std::span<const uint8_t> bytes);

// Of a file that begins with these bytes, of which there should be at least
// kPngHeadSize; nothing where it is no PNG file or its header is damaged.
constexpr size_t kPngHeadSize = 33;
std::optional<PngHeader> ReadPngHeader(std::span<const uint8_t> head);

// A file without defects, without all that is not needed for the pixels, such
// as colour profiles (of which libpng prints warnings) and texts.
std::vector<uint8_t> KeepCriticalChunks(std::span<const uint8_t> bytes);

}  // namespace tsar
