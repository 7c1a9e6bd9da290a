// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/rounding.h"

#include <cstdint>
#include <cstring>

namespace tsar {

// e^x for x <= 0 with a relative error of 3e-7; 0 below -85. The expf of CPU
// and GPU round differently; this one consists of additions and multiplications
// alone, so that both give the same bits and compilers vectorize loops of it.
TSAR_HD inline float ExpOfNegative(float x) {
  constexpr float kLowest = -85.f;
  constexpr float kLog2E = 1.44269504f;
  // ln 2 in two parts; n times the first, which has few bits, is exact.
  constexpr float kLn2High = 0.693359375f;
  constexpr float kLn2Low = -2.12194440e-4f;
  const float bounded = x > kLowest ? x : kLowest;
  // e^x = 2^n e^r with |r| <= ln(2) / 2.
  const float n = RoundToNearest(bounded * kLog2E);
  const float r = (bounded - n * kLn2High) - n * kLn2Low;
  float series = 1.f / 720.f;
  series = series * r + 1.f / 120.f;
  series = series * r + 1.f / 24.f;
  series = series * r + 1.f / 6.f;
  series = series * r + 0.5f;
  series = series * r + 1.f;
  series = series * r + 1.f;
  const int32_t bits = (static_cast<int32_t>(n) + 127) << 23;
  float power = 0.f;
  memcpy(&power, &bits, sizeof(power));
  return x > kLowest ? series * power : 0.f;
}

}  // namespace tsar
