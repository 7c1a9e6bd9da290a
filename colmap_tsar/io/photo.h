// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/input_file.h"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace tsar {

// Photos: the pixels that OpenCV decodes, converted to 8 bits. The EXIF
// orientation is ignored, as in COLMAP.
//
// A truncated file is rejected. Damage inside is found where the decoder fails,
// as for the checksums of PNG.
//
// All functions follow links and throw Error, naming the file: kNotFound (no
// such file), kIo (it cannot be read, or is no regular file), kCorrupt (empty,
// damaged, of no format of photos).

Image<Rgb> ReadPhoto(const std::filesystem::path& path);

// Reads gray as OpenCV decodes it, which for some formats is not that of the
// colors.
Image<uint8_t> ReadGrayPhoto(const std::filesystem::path& path);

// Whether one percent of the photo is exactly black and connected to its left
// or right border: most likely the area outside of the undistorted image.
bool HasBlackBorder(const Image<Rgb>& photo);

// Checks only the beginning and the end of a file, and decodes it only if these
// are not those of a complete one. Detects files that are missing, empty, of
// another format or, if JPEG or PNG, truncated; other damage is found when the
// photo is read.
void CheckPhotoFile(const std::filesystem::path& path);

struct PngHeader {
  int64_t width = 0;
  int64_t height = 0;
  bool has_alpha = false;
};

// Nullopt if the file is no PNG.
std::optional<PngHeader> ReadPngHeader(InputFile* file);

// Whether the last bytes are those of a complete file, with nothing after it,
// as far as its format has a marker at its end: JPEG and PNG.
bool EndsInMarker(InputFile* file);

}  // namespace tsar
