// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include <zlib.h>

namespace tsar {

// PNG files put together by hand, so that what is in them need not be right.
// Their checksums are.

inline std::string BigEndian(uint32_t number) {
  return {static_cast<char>(number >> 24),
          static_cast<char>(number >> 16),
          static_cast<char>(number >> 8),
          static_cast<char>(number)};
}

inline std::string PngChunk(const std::string& type,
                            const std::string& content) {
  const std::string covered = type + content;
  const uLong sum = crc32(0,
                          reinterpret_cast<const Bytef*>(covered.data()),
                          static_cast<uInt>(covered.size()));
  return BigEndian(static_cast<uint32_t>(content.size())) + covered +
         BigEndian(static_cast<uint32_t>(sum));
}

// The content of the first chunk. color_type: 0 gray, 2 colors, 3 palette, 4
// and 6 gray and colors with alpha.
inline std::string PngHeaderContent(uint32_t width,
                                    uint32_t height,
                                    int bits,
                                    int color_type,
                                    bool is_interlaced = false) {
  return BigEndian(width) + BigEndian(height) +
         std::string({static_cast<char>(bits),
                      static_cast<char>(color_type),
                      '\0',
                      '\0',
                      static_cast<char>(is_interlaced ? 1 : 0)});
}

// rows: each with the number of its filter before it.
inline std::string Deflated(const std::string& rows) {
  uLongf size = compressBound(rows.size());
  std::string stream(size, '\0');
  if (compress(reinterpret_cast<Bytef*>(stream.data()),
               &size,
               reinterpret_cast<const Bytef*>(rows.data()),
               rows.size()) != Z_OK) {
    throw std::runtime_error("zlib cannot compress");
  }
  return stream.substr(0, size);
}

// chunks: those between the first and the last one.
inline std::string PngFile(const std::string& header,
                           const std::string& chunks) {
  return "\x89PNG\r\n\x1a\n" + PngChunk("IHDR", header) + chunks +
         PngChunk("IEND", "");
}

// A gray picture of 8 bits whose checksums are right, but whose pixels break
// off in the middle of their compressed stream.
inline std::string PngWithBrokenStream(uint32_t width,
                                       uint32_t height,
                                       int bits = 8) {
  std::string rows;
  for (uint32_t y = 0; y < height; ++y) {
    rows += '\0';
    for (uint32_t i = 0; i < width * static_cast<uint32_t>(bits) / 8; ++i) {
      rows += static_cast<char>(y * 37 + i * i);
    }
  }
  const std::string stream = Deflated(rows);
  return PngFile(PngHeaderContent(width, height, bits, 0),
                 PngChunk("IDAT", stream.substr(0, stream.size() / 2)));
}

}  // namespace tsar
