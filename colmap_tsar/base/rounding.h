// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cstdint>
#include <cstring>

namespace tsar {

// 1.5 * 2^23: numbers of this size have no bits for fractions, so that adding
// it rounds to the nearest integer (the even one of two). For |x| <= 2^22.
constexpr float kRounder = 12582912.f;

TSAR_HD inline float RoundToNearest(float x) {
  return (x + kRounder) - kRounder;
}

TSAR_HD inline int32_t BitsOf(float x) {
  int32_t bits = 0;
  memcpy(&bits, &x, sizeof(bits));
  return bits;
}

// The integer n of the sum n + kRounder: where conversions are slow, as on
// GPUs, an addition and a subtraction take their place.
TSAR_HD inline int32_t IntegerBesideRounder(float sum) {
  constexpr int32_t kBitsOfRounder = 0x4B400000;
  return BitsOf(sum) - kBitsOfRounder;
}

}  // namespace tsar
