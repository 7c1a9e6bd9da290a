// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>

namespace tsar {

// What the first chunk of a PNG file says of its pixels, as it is written.
struct PngHeader {
  uint32_t width = 0;
  uint32_t height = 0;
  int bits_per_channel = 0;
  int color_type = 0;
  int compression = 0;
  int filter = 0;
  int interlacing = 0;

  bool HasPalette() const;
  // Whether there are such files, no larger than libpng and OpenCV decode.
  bool IsPossible() const;
};

// Whether the compressed data hold all rows of pixels and nothing else.
// parts: the contents of the chunks that they are spread over. The header must
// be possible. Memory is taken for one row. Throws std::bad_alloc.
bool HasAllPngRows(const PngHeader& header,
                   std::span<const std::span<const uint8_t>> parts);

}  // namespace tsar
