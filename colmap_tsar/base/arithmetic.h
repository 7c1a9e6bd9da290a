// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace tsar {

// Whether a value is neither NaN nor infinite: x - x is 0 for finite values
// alone. There are no branches, so that loops over maps are vectorized.
inline bool IsFinite(float value) { return value - value == 0.f; }

// Functions of floats that give the same bits on CPU and GPU.

// a b + c, rounded once: one instruction on a GPU and on a CPU with FMA, a slow
// call on another (avx2.h).
TSAR_HD inline float MultiplyAdd(float a, float b, float c) {
#ifdef __CUDA_ARCH__
  return __fmaf_rn(a, b, c);
#else
  return __builtin_fmaf(a, b, c);
#endif
}

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

constexpr int32_t kBitsOfRounder = 0x4B400000;

// The integer n of the sum n + kRounder: replaces a conversion, which is slow
// on GPUs, by an addition and a subtraction.
TSAR_HD inline int32_t IntegerBesideRounder(float sum) {
  return BitsOf(sum) - kBitsOfRounder;
}

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

// ln(x) for normal x > 0, with an error of at most 3e-7 (1 + |ln(x)|). Only
// additions, multiplications and one division are used, see ExpOfNegative().
TSAR_HD inline float NaturalLogarithm(float x) {
  // x = 2^n m with m in [sqrt(1/2), sqrt(2)).
  constexpr int32_t kSqrtHalf = 0x3f3504f3;
  int32_t bits = BitsOf(x);
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

// Half-precision floats (IEEE 754 binary16) as bits.

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
  const uint32_t exponent = (bits >> 10) & 0x1f;
  const uint32_t fraction = bits & 0x3ff;
  // The exponent's bias is 112 less than that of floats.
  const uint32_t float_exponent = exponent == 0x1f ? 0xff : exponent + 112;
  const float magnitude =
      exponent == 0
          ? static_cast<float>(fraction) * kMinHalf
          : std::bit_cast<float>(float_exponent << 23 | fraction << 13);
  return (bits & 0x8000) != 0 ? -magnitude : magnitude;
}

// The nearest integer, halves away from 0, of numbers up to 2^22: std::lround
// but for the last bit below a half, and inlined.
inline int RoundToInt(float value) {
  return static_cast<int>(value + std::copysign(0.5f, value));
}

}  // namespace tsar
