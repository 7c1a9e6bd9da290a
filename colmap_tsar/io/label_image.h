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
// one channel of up to 16 bits, in which pixels of one value are a segment, and
// 0 is none. They may have any size, but must have the aspect ratio of the
// image.

// The longest side of a label image that was read, in pixels: the raster of
// regions is smaller.
constexpr int kMaxLabelImageSide = 1024;

// The label image files of these images, sub/a.jpg.png or sub/a.png in the
// folder for sub/a.jpg; empty for images without one. option: the option that
// names the folder. Throws Error kNotFound if there is no such folder or it
// holds none of any of them.
std::vector<std::filesystem::path> FindLabelImages(
    const std::filesystem::path& folder,
    const std::vector<std::string>& image_names,
    const std::string& option);

// Reads the segments, reduced to kMaxLabelImageSide by nearest-neighbor
// sampling. image: the size of the undistorted image. Throws Error, naming the
// file: kNotFound (no such file), kIo (it cannot be read), kCorrupt (it is no
// PNG file, or damaged), kUnsupported (it has colors), kMismatch (its aspect
// ratio is not the image's).
Image<uint16_t> ReadLabelImage(const std::filesystem::path& path,
                               const RasterSize& image);

// Checks only the beginning and the end of the file, and decodes it only if the
// end is not that of a complete one. Returns the number of pixels. Throws the
// errors of ReadLabelImage; damage inside is found when it is read.
int64_t CheckLabelImage(const std::filesystem::path& path,
                        const RasterSize& image);

}  // namespace tsar
