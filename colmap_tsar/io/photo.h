// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <filesystem>

namespace tsar {

// Photos: JPEG, PNG, TIFF, WebP, BMP, PGM, PPM and JPEG 2000, told apart by
// their first bytes; of 8 bits, or brought to these. The pixels are those that
// OpenCV decodes; the orientation that a camera noted is ignored, as COLMAP
// does.
//
// A file that is cut off is refused, unless all pixels are there. Damage inside
// is refused where the format shows it: PNG and TIFF with Deflate have
// checksums; JPEG and TIFF with other compression are refused where the decoder
// stumbles, which it mostly does. WebP, JPEG 2000 and formats without
// compression (BMP, PGM, PPM, such TIFF) can only be checked for their length.
//
// All functions follow links and throw Error, naming the file: kNotFound (no
// such file), kIo (it cannot be read, or is no regular file), kCorrupt (empty,
// damaged, of no format of photos), kUnsupported (too many pixels).

Image<Rgb> ReadPhoto(const std::filesystem::path& path);

// Gray as OpenCV decodes it, which is not that of the colors for all formats.
Image<uint8_t> ReadGrayPhoto(const std::filesystem::path& path);

// Whether a PNG file says that it has an alpha channel, which is not read.
bool HasAlpha(const std::filesystem::path& path);

// Looks at the beginning and the end of a file alone, and decodes it only where
// these are not those of a whole one. Tells what is missing, empty, of another
// format or cut off; damage inside shows when the photo is read.
void CheckPhotoFile(const std::filesystem::path& path);

}  // namespace tsar
