// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/image.h"

#include <filesystem>
#include <string>

namespace tsar {

// The map as it is. Throws Error kMismatch, naming its file, where it is not of
// the size of another map of the image. other_name: such as "the depth map".
template <typename T>
Image<T> RequireSizeOf(const Image<float>& other,
                       const std::string& other_name,
                       const std::filesystem::path& path,
                       Image<T> map) {
  if (!map.HasSizeOf(other)) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "is of another size than " + other_name,
                      "refine the workspace again");
  }
  return map;
}

}  // namespace tsar
