// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/image.h"

namespace tsar {

// Resizing: averages for photos, nearest pixels for maps, which must not mix.
enum class Scaling { kAverage, kPick };

// The picture with a long side of at most max_size pixels; never enlarged.
Image<Rgb> FitPicture(const Image<Rgb>& picture, int max_size, Scaling scaling);

// Writes a photo as JPEG. Replaces the file atomically. Throws Error kIo.
void WriteJpeg(const ContainedPath& path, const Image<Rgb>& image);

// Writes PNG atomically; the name should end in ".png". Throws Error kIo.
void WritePng(const ContainedPath& path, const Image<Rgb>& image);

}  // namespace tsar
