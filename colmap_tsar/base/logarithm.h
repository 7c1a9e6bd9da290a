// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cstdint>
#include <cstring>

namespace tsar {

// ln(x) for normal x > 0, with an error of at most 3e-7 (1 + |ln(x)|). As in
// exponential.h, only additions, multiplications and one division are used, so
// that CPU and GPU give the same bits.
TSAR_HD inline float NaturalLogarithm(float x) {
  // x = 2^n m with m in [sqrt(1/2), sqrt(2)).
  constexpr int32_t kSqrtHalf = 0x3f3504f3;
  int32_t bits = 0;
  memcpy(&bits, &x, sizeof(bits));
  const int32_t n = (bits - kSqrtHalf) >> 23;
  bits -= n << 23;
  float m = 0.f;
  memcpy(&m, &bits, sizeof(m));
  // ln(m) = 2 artanh(s).
  const float s = (m - 1.f) / (m + 1.f);
  const float square = s * s;
  float series = 2.f / 9.f;
  series = series * square + 2.f / 7.f;
  series = series * square + 2.f / 5.f;
  series = series * square + 2.f / 3.f;
  series = series * square + 2.f;
  return static_cast<float>(n) * 0.693147181f + series * s;
}

}  // namespace tsar
