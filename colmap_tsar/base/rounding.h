// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cstdint>
#include <cstring>

namespace tsar {

// 1.5 * 2^23: floats of this size have no fractional bits, so that adding it
// rounds x to the nearest integer, ties to even, for |x| <= 2^22.
constexpr float kRounder = 12582912.f;

TSAR_HD inline float RoundToNearest(float x) {
  return (x + kRounder) - kRounder;
}

TSAR_HD inline int32_t BitsOf(float x) {
  int32_t bits = 0;
  memcpy(&bits, &x, sizeof(bits));
  return bits;
}

// The integer n of the sum n + kRounder: replaces a conversion, which is slow
// on GPUs, by an addition and a subtraction.
TSAR_HD inline int32_t IntegerBesideRounder(float sum) {
  constexpr int32_t kBitsOfRounder = 0x4B400000;
  return BitsOf(sum) - kBitsOfRounder;
}

}  // namespace tsar
