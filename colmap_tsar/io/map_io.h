// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/io/map_reader.h"
#include "colmap_tsar/io/written_map.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace tsar {

// COLMAP's raster files: ASCII "W&H&C&", then W*H*C float32, little-endian, one
// channel after the other. Depth maps have C = 1 (z in the camera frame, units
// of the sparse model, 0 = invalid), normal maps C = 3 (unit vectors in the
// camera frame, towards the camera, (0, 0, 0) = invalid).
//
// All readers throw Error: kNotFound where there is no such file, kCorrupt
// where the header is not exactly of this form or the file is not exactly as
// long as the header says. The length is checked before memory is allocated.

// Element (x, y) of channel c is values[(c * height + y) * width + x].
struct PlanarMap {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> values;
};

// Reads only the header, and checks the file's length.
MapSize ReadMapSize(const std::filesystem::path& path);

// Depths that are negative, NaN or infinite become 0; num_not_finite, if given,
// receives the number of the last two.
Image<float> ReadDepthMap(const std::filesystem::path& path,
                          int64_t* num_not_finite = nullptr);

// Normals with an element that is NaN or infinite become (0, 0, 0);
// num_not_finite, if given, receives their number.
Image<Vec3f> ReadNormalMap(const std::filesystem::path& path,
                           int64_t* num_not_finite = nullptr);

// Reads a map of any number of channels (cost maps: 2) with unchanged values.
PlanarMap ReadPlanarMap(const std::filesystem::path& path);

// The writers replace the file atomically (see AtomicFile). They reject, with
// kMismatch, maps that break COLMAP's fusion: empty maps and values that are
// not finite.
void WriteDepthMap(const ContainedPath& path, const Image<float>& depth);
void WriteNormalMap(const ContainedPath& path, const Image<Vec3f>& normal);
void WritePlanarMap(const ContainedPath& path, const PlanarMap& map);

// Writers to a file that the caller commits. They return its description
// without the time.
WrittenMap PutDepthMap(const Image<float>& depth, AtomicFile* file);
WrittenMap PutNormalMap(const Image<Vec3f>& normal, AtomicFile* file);
WrittenMap PutPlanarMap(const PlanarMap& map, AtomicFile* file);

}  // namespace tsar
