// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/scene/texture.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

constexpr int64_t kSide = 256;
constexpr int kMaxOctaves = 8;
// How much weaker an octave is than the one before. High, because matching
// depends on fine detail.
constexpr double kPersistence = 0.85;
constexpr double kGain = 0.7;

}  // namespace

LatticeNoise::LatticeNoise(uint32_t seed) : lattice_(kSide * kSide) {
  Philox random(seed, 0, 0);
  for (float& value : lattice_) {
    value = 2.f * random.NextFloat() - 1.f;
  }
}

double LatticeNoise::At(int64_t x, int64_t y) const {
  return lattice_[(y & (kSide - 1)) * kSide + (x & (kSide - 1))];
}

double LatticeNoise::Value(double x, double y) const {
  const double column = std::floor(x);
  const double row = std::floor(y);
  const double u = x - column;
  const double v = y - row;
  const auto c = static_cast<int64_t>(column);
  const auto r = static_cast<int64_t>(row);
  const double top = (1.0 - u) * At(c, r) + u * At(c + 1, r);
  const double bottom = (1.0 - u) * At(c, r + 1) + u * At(c + 1, r + 1);
  return (1.0 - v) * top + v * bottom;
}

double LatticeNoise::Texture(double x,
                             double y,
                             double cell,
                             double footprint) const {
  double sum = 0.0;
  double amplitude = kGain;
  for (int octave = 0; octave < kMaxOctaves; ++octave) {
    const double visible = std::clamp(cell / (1.5 * footprint) - 1.0, 0.0, 1.0);
    if (visible == 0.0) {
      break;
    }
    // Shifted, so that the lattices of the octaves do not coincide.
    sum += visible * amplitude *
           Value(x / cell + 37.3 * octave, y / cell + 71.7 * octave);
    amplitude *= kPersistence;
    cell *= 0.5;
  }
  return std::clamp(sum, -1.0, 1.0);
}

}  // namespace tsar
