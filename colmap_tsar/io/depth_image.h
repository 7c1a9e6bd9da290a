// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/float_map.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace tsar {

// A depth or normal map in a format of images or arrays.
struct DepthImage {
  FloatMap map;  // One or three channels; those of pictures are red first.
  bool is_integer = false;  // Stored in integers: the unit is uncertain.
};

// Whether a file's name ends in .png, .exr, .tif, .tiff, .pfm or .npy, in any
// case.
bool IsDepthImageName(const std::filesystem::path& path);

// Reads the bytes of such a file: PNG of 16 bits and one channel, EXR and TIFF
// of floats (or, TIFF, of 16 bits) with one or three channels, PFM (see
// ParsePfm), NPY (see ParseNpy). A picture of three equal channels counts as
// one channel, which some programs write for depth.
//
// path: the file's name, which determines the format, also for messages. Throws
// Error: kCorrupt (the content breaks the format), kUnsupported (a picture that
// cannot be depth, such as one of 8 bits; or OpenCV was built without EXR).
DepthImage ParseDepthImage(std::span<const uint8_t> bytes,
                           const std::filesystem::path& path);

// Reads the same formats as normals, three values for each pixel, as floats: as
// stored or, for integers (also of 8 bits, in PNG and TIFF), 2 * value /
// largest value - 1; (0, 0, 0) if that is far from a unit vector. Throws Error:
// kCorrupt, kUnsupported (not of three channels).
FloatMap ParseNormalImage(std::span<const uint8_t> bytes,
                          const std::filesystem::path& path);

}  // namespace tsar
