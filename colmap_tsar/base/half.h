// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cmath>
#include <cstdint>

namespace tsar {

// Half-precision floats (IEEE 754 binary16) as bits. CPU and GPU give the same
// bits.

constexpr float kMinHalf = 1.f / 16777216.f;  // 2^-24.
constexpr float kMaxHalf = 65504.f;

// The nearest half to a number above 0, clamped to the smallest and the largest
// half.
TSAR_HD inline uint16_t ToPositiveHalf(float value) {
  const float bounded = fminf(fmaxf(value, kMinHalf), kMaxHalf);
  // Between two powers of two there are 1024 halves, and as many below the
  // smallest normal one, all one unit apart.
  constexpr int kNumFractions = 1024;
  float unit = kMinHalf;
  int exponent = 1;
  while (bounded >= 2 * kNumFractions * unit) {
    unit *= 2.f;
    ++exponent;
  }
  const int level = static_cast<int>(bounded / unit + 0.5f);
  return static_cast<uint16_t>(kNumFractions * exponent +
                               (level - kNumFractions));
}

inline float HalfToFloat(uint16_t bits) {
  const int exponent = (bits >> 10) & 0x1f;
  const int fraction = bits & 0x3ff;
  const float magnitude =
      exponent == 0 ? static_cast<float>(fraction) * kMinHalf
      : exponent == 0x1f
          ? (fraction == 0 ? INFINITY : NAN)
          : std::ldexp(static_cast<float>(1024 + fraction), exponent - 25);
  return (bits & 0x8000) != 0 ? -magnitude : magnitude;
}

}  // namespace tsar
