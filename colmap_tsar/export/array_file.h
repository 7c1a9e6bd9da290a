// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

#include <cstdint>

namespace tsar {

// Write an array of NumPy's format (.npy, version 1.0), little-endian and row
// by row: float32, uint8 or uint16 of shape (height, width), or float32 of
// (height, width, 3). In one step; create the folder. Errors as AtomicFile.
void WriteArray(const ContainedPath& path, const Image<float>& values);
void WriteArray(const ContainedPath& path, const Image<Vec3f>& values);
void WriteArray(const ContainedPath& path, const Image<uint8_t>& values);
void WriteArray(const ContainedPath& path, const Image<uint16_t>& values);

}  // namespace tsar
