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

struct Rgb16 {
  uint16_t r = 0;
  uint16_t g = 0;
  uint16_t b = 0;
};

// Decodes a PNG file. T: Rgb or uint8_t for 8 bits, as cv::imdecode() decodes
// any file; Rgb16 for 16 bits, where 255 of 8 bits becomes 65535; uint16_t only
// for a gray picture of 16 bits. A declared size beyond what the file can hold
// allocates no memory. Throws the result of `error`, and std::bad_alloc.
template <typename T>
Image<T> DecodePng(std::span<const uint8_t> bytes, const PngError& error);

}  // namespace tsar
