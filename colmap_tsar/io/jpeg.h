// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// JPEG, decoded by libjpeg, since OpenCV takes no notice of its warnings: where
// the data break off the rest of the picture would be gray, and nobody told.
// Here whatever libjpeg says about the compressed data is an error: that they
// end too early or too late, that a code is wrong, that markers are missing.
// What it says about metadata (the version of JFIF, Adobe's transform) is not.
//
// A file that is cut off anywhere is refused, since the marker of its end is
// missing. Other damage is noticed only where the decoder stumbles: JPEG has no
// checksums, and a single wrong bit may give other colors and nothing else.
//
// All functions take the bytes of a file and its name, for messages. They throw
// Error: kCorrupt (damaged, or nothing that libjpeg can decode) and
// kUnsupported (too many pixels).

struct JpegKind {
  int width = 0;
  int height = 0;
  bool is_cmyk = false;  // In four inks, as printers use them.
};

// Reads no further than to the first pixel.
JpegKind ReadJpegKind(std::span<const uint8_t> bytes, const std::string& name);

// The pixels that cv::imdecode gives, for pictures that are not in CMYK. The
// orientation that a camera noted is ignored.
Image<Rgb> DecodeJpeg(std::span<const uint8_t> bytes, const std::string& name);
Image<uint8_t> DecodeGrayJpeg(std::span<const uint8_t> bytes,
                              const std::string& name);

// Decodes a picture of any kind to look for damage alone.
void CheckJpeg(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace tsar
