// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/priors/depth_prior.h"

#include <cstdint>
#include <filesystem>

namespace tsar {

// The files of one image's prior. Either may be empty: there is none.
struct PriorFiles {
  std::filesystem::path depth;
  std::filesystem::path normals;

  bool Empty() const { return depth.empty() && normals.empty(); }
};

// A prior describes walls and floors, not details: its rasters are kept at this
// longer side at most, so that they take little memory beside the maps.
constexpr int kMaxPriorSide = 1024;

// Reads the files of an image whose undistorted photo has this size, by
// ParseDepthImage() and ParseNormalImage(). Larger rasters are reduced by
// taking the nearest pixel. Values that are negative or not finite become 0,
// normals unit vectors or (0, 0, 0).
//
// Throws Error, naming the file: kNotFound (no such file), kIo (it cannot be
// read, or is a folder), kCorrupt, kUnsupported (such as depth of 8 bits),
// kMismatch (its aspect ratio differs from the photo's by more than 2 % and by
// more than one of its pixels).
DepthPrior ReadPrior(const PriorFiles& files,
                     PriorType type,
                     const RasterSize& photo);

// The main memory of a prior, in bytes.
struct PriorMemory {
  int64_t prior = 0;
  int64_t to_read = 0;  // Beside the prior, while it is read.
};

// The memory of the files, which it reads. Throws what ReadPrior throws.
PriorMemory CheckPrior(const PriorFiles& files, const RasterSize& photo);

}  // namespace tsar
