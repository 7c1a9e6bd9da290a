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

// Masks: PNG files that users give with the undistorted images, in a folder of
// their own. They follow COLMAP's mask_path: that of the image sub/a.jpg is
// sub/a.jpg.png in the folder of masks. The mask of an image sub/a.png may also
// have its name if there is no sub/a.png.png. Pixels of value 0 (black) are
// masked, all others are not; colors are converted to gray; a mask that
// shows in its alpha channel alone is refused. Images without a mask are used
// entirely.

// Throws Error kBadOption if this folder, for other content, is the images'
// own. content: the expected content, such as "masks"; option: the option that
// names the folder.
void RequireNoImageFolder(const std::filesystem::path& folder,
                          const std::filesystem::path& images,
                          const std::string& content,
                          const std::string& option);

// The masks of these images; empty for images without one. option: the option
// that names the folder. Throws Error kNotFound if there is no such folder or
// it holds no mask of any of them.
std::vector<std::filesystem::path> FindImageMasks(
    const std::filesystem::path& folder,
    const std::vector<std::string>& image_names,
    const std::string& option);

// Warns of pictures in a folder of masks that are none of these.
void WarnOfStrayMasks(const std::filesystem::path& folder,
                      const std::vector<std::filesystem::path>& masks);

// The permitted sizes of a mask: that of the undistorted image and that of its
// maps.
struct MaskSizes {
  RasterSize image;
  RasterSize maps;
};

// Reads a mask at its own size: 1 where the image is masked, 0 elsewhere.
// Throws Error, naming the file: kNotFound (no such file), kIo (it cannot be
// read), kCorrupt (it is no PNG file, or damaged), kMismatch (another size).
Image<uint8_t> ReadImageMask(const std::filesystem::path& path,
                             const MaskSizes& sizes);

// Checks only the beginning and the end of a file, and decodes it only if the
// end is not that of a complete one. Throws the errors of ReadImageMask; damage
// inside is found when the file is read.
void CheckImageMask(const std::filesystem::path& path, const MaskSizes& sizes);

// The mask at another size. A pixel is masked if any pixel that it covers is: a
// depth that mixes masked content is useless.
Image<uint8_t> ResizeMask(const Image<uint8_t>& mask, const RasterSize& size);

// Sets the masked pixels of a map to a value. An empty mask masks nothing; the
// map may be empty, too.
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
