// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <filesystem>

namespace tsar {

// The maps of a refined workspace beside depth and normal maps. All readers
// throw Error kNotFound (no such file), and kCorrupt for anything but such a
// map.

// Read a picture of one channel: confidence and provenance maps have 8 bits,
// plane maps (the number of the scene plane of each pixel) 16.
Image<uint8_t> ReadGrayPng(const std::filesystem::path& path);
Image<uint16_t> ReadGray16Png(const std::filesystem::path& path);

// Sigma maps: the standard deviation of each depth, in the units of the depth
// map; 0 where there is no depth. Files are arrays of NumPy's format (.npy,
// version 1.0) of little-endian half floats ('<f2'), height x width, row by
// row.

// Writes a map into a file that the caller commits. halves: the bits of each
// value, see arithmetic.h.
void PutSigmaMap(const Image<uint16_t>& halves, AtomicFile* file);

// Reads a map; no value may be negative or not finite.
Image<float> ReadSigmaMap(const std::filesystem::path& path);

}  // namespace tsar
