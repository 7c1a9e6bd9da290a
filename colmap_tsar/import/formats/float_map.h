// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/import/formats/byte_reader.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tsar {

// A raster as other programs store it: row by row, the channels of a pixel side
// by side. Values are as in the file, also those that are not finite.
struct FloatMap {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> values;  // [(y * width + x) * channels + c]
};

// The number of values of a raster whose header says width x height x
// channels, each of num_value_bytes, after making sure that `reader` holds
// exactly that many; Error kCorrupt otherwise.
size_t RequireExactLength(const ByteReader& reader,
                          int64_t width,
                          int64_t height,
                          int64_t channels,
                          size_t num_value_bytes);

// A map of one channel. Values that are negative, NaN or infinite become 0,
// which is "no depth". Error kCorrupt, naming the file, for more channels.
Image<float> ToDepth(const FloatMap& map, const std::string& name);

// A map of three channels as it is. Normals with an element that is NaN or
// infinite become (0, 0, 0). Error kCorrupt for another number of channels.
Image<Vec3f> ToNormals(const FloatMap& map, const std::string& name);

}  // namespace tsar
