// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/image.h"

#include <vector>

namespace tsar {

// How a raster is brought to another size: averaging for photos; picking for
// maps, whose values must not be mixed.
enum class Scaling { kAverage, kPick };

// The picture with a long side of at most max_size pixels; never enlarged.
Image<Rgb> FitPicture(const Image<Rgb>& picture, int max_size, Scaling scaling);

// Pictures of the same height, side by side. At least one.
Image<Rgb> JoinPictures(const std::vector<Image<Rgb>>& pictures);

// For photos: as JPEG. Replaces the file in one step. Throws Error kIo.
void WriteJpeg(const ContainedPath& path, const Image<Rgb>& image);

// Replaces the file in one step; the name should end in ".png". Throws Error
// kIo.
void WritePng(const ContainedPath& path, const Image<Rgb>& image);

}  // namespace tsar
