// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

namespace tsar {

// A small picture as a file of one of the kinds that photos come in.
struct PhotoSample {
  std::string name;  // Such as "progressive.jpg".
  std::string bytes;
  // That the picture's data are compressed or have checksums, so that damage
  // shows: where a stretch of them is zeroed, and where a bit is flipped.
  bool shows_zeros = false;
  bool shows_flips = false;
};

// Of every kind one; all show the same picture of 128 x 96 pixels, in colors
// or in gray.
std::vector<PhotoSample> MakePhotoSamples();

// The one of this name.
PhotoSample FindPhotoSample(const std::string& name);

}  // namespace tsar
