// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/tools/export/map_levels.h"

#include <cstdint>

namespace tsar {

// All functions write atomically and create the folder. Errors as AtomicFile,
// and kIo if OpenCV cannot encode the picture.

// Write an array in NumPy's format (.npy, version 1.0), little-endian, by row:
// float32, uint8 or uint16, (height, width), or float32, (height, width, 3).
void WriteArray(const ContainedPath& path, const Image<float>& values);
void WriteArray(const ContainedPath& path, const Image<Vec3f>& values);
void WriteArray(const ContainedPath& path, const Image<uint8_t>& values);
void WriteArray(const ContainedPath& path, const Image<uint16_t>& values);

// Write PNG: one channel, or red, green and blue, of 8 or 16 bits.
void WritePngFile(const ContainedPath& path, const Image<uint8_t>& values);
void WritePngFile(const ContainedPath& path, const Image<uint16_t>& values);
void WritePngFile(const ContainedPath& path, const Image<Rgb>& values);
void WritePngFile(const ContainedPath& path, const Image<Rgb16>& values);

// Write OpenEXR of 32-bit floats, losslessly: Y, or x, y, z as R, G, B.
void WriteExrFile(const ContainedPath& path, const Image<float>& values);
void WriteExrFile(const ContainedPath& path, const Image<Vec3f>& values);

// Throws Error kUnsupported if OpenCV cannot write EXR. Call before threads.
void RequireExr();

}  // namespace tsar
