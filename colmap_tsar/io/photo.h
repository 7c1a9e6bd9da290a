// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <filesystem>

namespace tsar {

// Photos: JPEG, PNG, TIFF, WebP, BMP, PGM, PPM and JPEG 2000, identified by
// their first bytes and converted to 8 bits. The pixels are those that OpenCV
// decodes; the EXIF orientation is ignored, as in COLMAP.
//
// A truncated file is rejected, unless it has all pixels. Damage inside is
// found as far as the format allows: PNG and TIFF with Deflate have checksums;
// the decoders of JPEG and of TIFF with other compression mostly fail. WebP,
// JPEG 2000 and formats without compression (BMP, PGM, PPM, such TIFF) can only
// be checked for their length.
//
// All functions follow links and throw Error, naming the file: kNotFound (no
// such file), kIo (it cannot be read, or is no regular file), kCorrupt (empty,
// damaged, of no format of photos), kUnsupported (too many pixels).

Image<Rgb> ReadPhoto(const std::filesystem::path& path);

// Reads gray as OpenCV decodes it, which for some formats is not that of the
// colors.
Image<uint8_t> ReadGrayPhoto(const std::filesystem::path& path);

// Whether a PNG file says that it has an alpha channel, which is not read.
bool HasAlpha(const std::filesystem::path& path);

// Looks at the beginning and the end of a file alone, and decodes it only where
// these are not those of a whole one. Tells what is missing, empty, of another
// format or cut off; damage inside shows when the photo is read.
void CheckPhotoFile(const std::filesystem::path& path);

}  // namespace tsar
