// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// Decoding of JPEG by libjpeg, since OpenCV ignores its warnings: the rest of
// truncated data would silently be gray. Here every warning about the
// compressed data is an error: a premature or late end, a wrong code, missing
// markers. Warnings about metadata (the version of JFIF, Adobe's transform) are
// not.
//
// A truncated file is rejected, since its end marker is missing. Other damage
// is found only if the decoder fails: JPEG has no checksums, and a wrong bit
// may only change colors.
//
// All functions take the bytes of a file and its name, for messages. They throw
// Error: kCorrupt (damaged, or nothing that libjpeg can decode) and
// kUnsupported (too many pixels).

struct JpegKind {
  int width = 0;
  int height = 0;
  bool is_cmyk = false;  // Four inks, as for printing.
};

// Reads only the header.
JpegKind ReadJpegKind(std::span<const uint8_t> bytes, const std::string& name);

// Decodes the pixels as cv::imdecode does, for pictures that are not in CMYK.
// The EXIF orientation is ignored. T: Rgb, or uint8_t for gray.
template <typename T>
Image<T> DecodeJpeg(std::span<const uint8_t> bytes, const std::string& name);

// Decodes a picture of any kind only to find damage.
void CheckJpeg(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace tsar
