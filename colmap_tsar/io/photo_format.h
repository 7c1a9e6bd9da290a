// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace tsar {

// The supported formats of photos, whose files can be checked for completeness.
// OpenCV decodes others, which photos do not use.
enum class PhotoFormat {
  kJpeg,
  kPng,
  kTiff,
  kBmp,
  kWebp,
  kPnm,  // PGM and PPM, binary or text.
  kJpeg2000,
};

// Detects the format by the first bytes of a file, whatever its name.
std::optional<PhotoFormat> FormatOf(std::span<const uint8_t> head);

// The least size of a file in bytes by its header: known for BMP, binary PNM
// and WebP; for TIFF the offset of the directory, which is mostly at the end. 0
// if the header does not tell it or is incomplete.
uint64_t DeclaredSize(PhotoFormat format, std::span<const uint8_t> head);

// Whether a text PGM or PPM has as many numbers as its header declares, the
// last one followed by another byte; true for the binary form.
bool HasAllNumbers(std::span<const uint8_t> bytes);

// Whether the last bytes of a file are the marker that ends JPEG, PNG and JPEG
// 2000, with nothing after it; true for other formats.
bool EndsInMarker(PhotoFormat format, std::span<const uint8_t> tail);

// Whether the data of JPEG 2000 are complete; other boxes may follow.
bool HasJpeg2000End(std::span<const uint8_t> bytes);

}  // namespace tsar
