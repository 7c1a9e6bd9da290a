// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

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

// The bytes at the end of a file that EndsInMarker looks at.
inline constexpr uint64_t kTailBytes = 16;

// Whether the last bytes of a file are the marker that ends JPEG, PNG and JPEG
// 2000, with nothing after it; true for other formats.
bool EndsInMarker(PhotoFormat format, std::span<const uint8_t> tail);

// Whether the data of JPEG 2000 are complete; other boxes may follow.
bool HasJpeg2000End(std::span<const uint8_t> bytes);

// The most pixels of a photo: OpenCV's limit. Pixels are also indexed by an
// int.
inline constexpr int64_t kMaxNumPixels = int64_t{1} << 30;

// The errors of the files in this folder that decode photos. name: the file;
// what: the reason, such as "it breaks off".
//
// The error for a known format with incomplete content (kCorrupt).
Error DamagedPhoto(const std::string& name, const std::string& what);
// The error for a file that cannot be decoded (kCorrupt).
Error UnreadablePhoto(const std::string& name, const std::string& what);

// Throws kUnsupported for too many pixels. Must be called before memory is
// allocated for them.
void RequirePossibleSize(const std::string& name,
                         int64_t width,
                         int64_t height);

}  // namespace tsar
