// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/photo_error.h"

namespace tsar {

Error DamagedPhoto(const std::string& name, const std::string& what) {
  return Error::File(
      ErrorCode::kCorrupt,
      name,
      "the image is damaged: " + what,
      "make the workspace again with image_undistorter, from a whole photo");
}

Error UnreadablePhoto(const std::string& name, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     name,
                     "not a readable image: " + what,
                     "make the workspace again with image_undistorter");
}

void RequirePossibleSize(const std::string& name,
                         int64_t width,
                         int64_t height) {
  // A division is used, since the product of two untrusted numbers may
  // overflow.
  if (width > 0 && height > kMaxNumPixels / width) {
    throw Error::File(ErrorCode::kUnsupported,
                      name,
                      "has " + std::to_string(width) + " x " +
                          std::to_string(height) +
                          " pixels, more than the 2^30 that can be worked on",
                      "run image_undistorter with a smaller --max_image_size");
  }
}

}  // namespace tsar
