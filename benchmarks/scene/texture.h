// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

namespace tsar {

// Smooth random numbers on a plane: values on an integer lattice, interpolated.
// The lattice repeats after 256 cells.
class LatticeNoise {
 public:
  explicit LatticeNoise(uint32_t seed);

  // In [-1, 1], continuous; one cell is 1 wide.
  double Value(double x, double y) const;

  // The sum of octaves of Value(), each half as wide as the one before, in
  // about [-1, 1]: the first has cells of this width, and those too small to
  // be seen at the footprint (the width of a pixel on the surface) fade out.
  double Texture(double x, double y, double cell, double footprint) const;

 private:
  double At(int64_t x, int64_t y) const;

  std::vector<float> lattice_;
};

}  // namespace tsar
