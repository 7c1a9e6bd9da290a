// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cmath>
#include <cstdint>

namespace tsar {

// What is known of the depth that a pixel measured, in one byte: whether it is
// trusted (bit 7), how many other views confirm it (bits 5 and 6), and its
// score (bits 0 to 4).
struct MeasurementRating {
  static constexpr int kMaxConfirmations = 3;
  static constexpr int kMaxScore = 31;

  // score: in [0, 1]; what lies outside is clamped.
  TSAR_HD static uint8_t Pack(bool is_trusted, int confirmations, float score) {
    const float level = fminf(fmaxf(kMaxScore * score + 0.5f, 0.f), kMaxScore);
    const int votes =
        confirmations < kMaxConfirmations ? confirmations : kMaxConfirmations;
    return static_cast<uint8_t>((is_trusted ? 1 << 7 : 0) | votes << 5 |
                                static_cast<int>(level));
  }
  TSAR_HD static bool IsTrusted(uint8_t rating) { return rating >> 7 != 0; }
  TSAR_HD static int Confirmations(uint8_t rating) { return rating >> 5 & 3; }
  TSAR_HD static float Score(uint8_t rating) {
    return static_cast<float>(rating & kMaxScore) / kMaxScore;
  }
  TSAR_HD static uint8_t WithoutTrust(uint8_t rating) {
    return static_cast<uint8_t>(rating & ~(1 << 7));
  }
};

}  // namespace tsar
