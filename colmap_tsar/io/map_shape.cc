// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_shape.h"

#include <cmath>

namespace tsar {

std::string ToString(const RasterSize& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

bool HasShapeOf(const RasterSize& size, const RasterSize& whole) {
  const double width = whole.width;
  const double height = whole.height;
  // The error of each side relative to the scale of the other one.
  const double error_x = std::abs(size.width - size.height / height * width);
  const double error_y = std::abs(size.height - size.width / width * height);
  return error_x <= 1.0 + width / height || error_y <= 1.0 + height / width;
}

void RequireShape(const std::filesystem::path& path,
                  const RasterSize& size,
                  const RasterSize& whole,
                  const std::string& whole_name,
                  const std::string& advice) {
  if (!HasShapeOf(size, whole)) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "has " + ToString(size) +
                          " pixels, which is not the shape of " + whole_name +
                          " of " + ToString(whole),
                      advice);
  }
}

}  // namespace tsar
