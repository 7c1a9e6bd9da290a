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

// PNG, decoded by libpng without a line on the standard error. Whatever libpng
// says about the pixels is an error: checksums, data that end too early or too
// late, chunks that make no sense. What it says about the rest, such as color
// profiles and texts, is not: that is skipped, and so is transparency.

struct PngHeader {
  uint32_t width = 0;
  uint32_t height = 0;
  int bits_per_channel = 0;
  bool is_gray = false;  // Without transparency.
  bool has_colors = false;
};

// Of a file that begins with these bytes, of which there should be at least
// kPngHeadSize; nothing where it is no PNG file or its header is damaged.
constexpr size_t kPngHeadSize = 33;
std::optional<PngHeader> ReadPngHeader(std::span<const uint8_t> head);

// The error to throw for a file; defect: what is wrong with it.
using PngError = std::function<Error(const std::string& defect)>;

// The pixels of any PNG file, of 8 bits, as cv::imdecode() gives them. A header
// that says more than the file can hold costs no memory. Throw what `error`
// makes, and std::bad_alloc.
Image<Rgb> DecodePng(std::span<const uint8_t> bytes, const PngError& error);
Image<uint8_t> DecodeGrayPng(std::span<const uint8_t> bytes,
                             const PngError& error);

// The same of a gray picture of 16 bits.
Image<uint16_t> DecodeGray16Png(std::span<const uint8_t> bytes,
                                const PngError& error);

struct Rgb16 {
  uint16_t r = 0;
  uint16_t g = 0;
  uint16_t b = 0;
};

// The pixels of any PNG file, of 16 bits: 255 of 8 bits becomes 65535.
Image<Rgb16> DecodePng16(std::span<const uint8_t> bytes, const PngError& error);

}  // namespace tsar
