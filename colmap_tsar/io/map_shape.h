// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/image.h"

#include <filesystem>
#include <string>

namespace tsar {

// Returns the map unchanged. Throws Error kMismatch with its file if its size
// differs from that of the image's depth map.
template <typename T>
Image<T> RequireSizeOf(const Image<float>& depth,
                       const std::filesystem::path& path,
                       Image<T> map) {
  if (!map.HasSizeOf(depth)) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "is of another size than the depth map",
                      "refine the workspace again");
  }
  return map;
}

// A size in pixels; both sides are positive.
struct RasterSize {
  int width = 0;
  int height = 0;
};

// "640 x 480", for messages.
std::string ToString(const RasterSize& size);

// Whether two sizes have the same aspect ratio up to rounding of each side by
// less than a pixel. Maps may be smaller or larger than their images, since
// max_image_size scales them.
bool HasShapeOf(const RasterSize& size, const RasterSize& whole);

// Throws Error kMismatch with the file and both sizes unless HasShapeOf()
// holds. whole_name: such as "the image v0.png".
void RequireShape(const std::filesystem::path& path,
                  const RasterSize& size,
                  const RasterSize& whole,
                  const std::string& whole_name,
                  const std::string& advice);

}  // namespace tsar
