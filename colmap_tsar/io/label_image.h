// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/io/map_shape.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// Label images hold a segmentation of an image by another program: PNG files of
// one channel with up to 16 bits, in which pixels of one number are a segment,
// and 0 is none. They may have any size, but must have the shape of the image.

// Of a label image that was read, the longest side in pixels: the raster on
// which regions are found is smaller.
constexpr int kMaxLabelImageSide = 1024;

// The files of the label images of these images, sub/a.jpg.png or sub/a.png in
// the folder for sub/a.jpg; empty for those without one. option: what the
// folder was given with. Throws Error kNotFound where there is no such folder,
// or it holds none for any of them.
std::vector<std::filesystem::path> FindLabelImages(
    const std::filesystem::path& folder,
    const std::vector<std::string>& image_names,
    const std::string& option);

// The segments, reduced to kMaxLabelImageSide by taking the pixel under the
// middle of each. image: the size of the undistorted image. Throws Error,
// naming the file: kNotFound (no such file), kIo (it cannot be read), kCorrupt
// (it is no PNG file, or damaged), kUnsupported (it has colors), kMismatch (it
// is not of the image's shape).
Image<uint16_t> ReadLabelImage(const std::filesystem::path& path,
                               const RasterSize& image);

// Looks at the beginning and the end of the file alone, and decodes it only
// where the end is not that of a whole one. Returns how many pixels it has.
// Throws what ReadLabelImage throws; damage inside shows when it is read.
int64_t CheckLabelImage(const std::filesystem::path& path,
                        const RasterSize& image);

}  // namespace tsar
