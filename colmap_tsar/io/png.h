// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/image.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace tsar {

// Decoding of PNG by libpng without output to standard error. Every warning
// about the pixels is an error: checksums, a premature or late end of data,
// invalid chunks. Other chunks, such as color profiles and texts, and
// transparency are ignored.

struct PngHeader {
  uint32_t width = 0;
  uint32_t height = 0;
  int bits_per_channel = 0;
  bool is_gray = false;  // Gray without transparency.
  bool has_colors = false;
  bool has_alpha = false;
};

// The header of a file that begins with these bytes, at least kPngHeadSize;
// nullopt if it is no PNG file or its header is damaged.
constexpr size_t kPngHeadSize = 33;
std::optional<PngHeader> ReadPngHeader(std::span<const uint8_t> head);

// Makes the error to throw for a file with this defect.
using PngError = std::function<Error(const std::string& defect)>;

// Decode any PNG file to 8 bits, as cv::imdecode() does. A declared size beyond
// what the file can hold allocates no memory. Throw the result of `error`, and
// std::bad_alloc.
Image<Rgb> DecodePng(std::span<const uint8_t> bytes, const PngError& error);
Image<uint8_t> DecodeGrayPng(std::span<const uint8_t> bytes,
                             const PngError& error);

// Decodes a gray picture of 16 bits.
Image<uint16_t> DecodeGray16Png(std::span<const uint8_t> bytes,
                                const PngError& error);

struct Rgb16 {
  uint16_t r = 0;
  uint16_t g = 0;
  uint16_t b = 0;
};

// Decodes any PNG file to 16 bits: 255 of 8 bits becomes 65535.
Image<Rgb16> DecodePng16(std::span<const uint8_t> bytes, const PngError& error);

}  // namespace tsar
