// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/io/map_shape.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// Masks as COLMAP's mask_path takes them: that of the image sub/a.jpg is
// sub/a.jpg.png in the folder of masks. Where an image is called sub/a.png and
// there is no sub/a.png.png, its mask may have its own name. Pixels of value 0
// (black) are masked, all others are not; colors are brought to gray. Images
// without a mask are used as a whole.

// The files of the masks of these images; empty for those without one. option:
// what the folder was given with. Throws Error kNotFound where there is no such
// folder or it holds no mask of any of them.
std::vector<std::filesystem::path> FindImageMasks(
    const std::filesystem::path& folder,
    const std::vector<std::string>& image_names,
    const std::string& option);

// The sizes that a mask may have: that of the undistorted image, and that of
// its maps.
struct MaskSizes {
  RasterSize image;
  RasterSize maps;
};

// 1 where the image is masked, 0 elsewhere, at the mask's own size. Throws
// Error, naming the file: kNotFound (no such file), kIo (it cannot be read),
// kCorrupt (it is no PNG file, or damaged), kUnsupported (16 bits per channel),
// kMismatch (another size).
Image<uint8_t> ReadImageMask(const std::filesystem::path& path,
                             const MaskSizes& sizes);

// Looks at the beginning and the end of the file alone, and decodes it only
// where the end is not that of a whole one. Throws what ReadImageMask throws;
// damage inside shows when the mask is read.
void CheckImageMask(const std::filesystem::path& path, const MaskSizes& sizes);

// The mask at another size. A pixel is masked where any of those that it covers
// is: a depth that is in part of something else is of no use.
Image<uint8_t> ResizeMask(const Image<uint8_t>& mask, const RasterSize& size);

// Sets the masked pixels of a map. Masks may be empty, which mask nothing, and
// so may maps.
template <typename T>
void ClearMasked(const Image<uint8_t>& mask, Image<T>* map, T value = {}) {
  if (mask.Empty() || map->Empty()) {
    return;
  }
  for (size_t i = 0; i < map->NumPixels(); ++i) {
    if (mask.Data()[i] != 0) {
      map->Data()[i] = value;
    }
  }
}

}  // namespace tsar
