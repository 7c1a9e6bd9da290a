// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace tsar {

// The formats of photos, of which it is known how to tell whether a file is
// whole. OpenCV decodes others too, which nobody's photos have.
enum class PhotoFormat {
  kJpeg,
  kPng,
  kTiff,
  kBmp,
  kWebp,
  kPnm,  // PGM and PPM, binary or text.
  kJpeg2000,
};

// By the first bytes of a file, whatever its name.
std::optional<PhotoFormat> FormatOf(std::span<const uint8_t> head);

// How many bytes a file has at least, by its header: BMP, PNM in binary form,
// and WebP tell that; TIFF tells where its directory begins, which mostly is at
// the end. 0 where the header does not tell or is not all there.
uint64_t DeclaredSize(PhotoFormat format, std::span<const uint8_t> head);

// Whether a PGM or PPM in the form of text has as many numbers as its header
// says, the last one with something behind it; true for the binary form.
bool HasAllNumbers(std::span<const uint8_t> bytes);

// Whether the last bytes of a file are the marker that ends JPEG, PNG and JPEG
// 2000, with nothing behind it; true for other formats.
bool EndsInMarker(PhotoFormat format, std::span<const uint8_t> tail);

// Whether the data of JPEG 2000 reach their end: other boxes may stand behind.
bool HasJpeg2000End(std::span<const uint8_t> bytes);

}  // namespace tsar
