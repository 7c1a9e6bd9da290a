// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cmath>
#include <cstdint>

namespace tsar {

// What is known of the depth that a pixel measured, in one byte: whether it is
// trusted and its score, and how many other views confirm it.
struct MeasurementRating {
  static constexpr int kMaxScore = 63;
  static constexpr int kMaxConfirmations = 3;

  // A trusted depth keeps its trust where nothing judged it.
  TSAR_HD static uint8_t Pack(bool is_trusted, float score, int confirmations) {
    const float level = fminf(fmaxf(ceilf(kMaxScore * score), 1.f), kMaxScore);
    const int votes =
        confirmations < kMaxConfirmations ? confirmations : kMaxConfirmations;
    return static_cast<uint8_t>(
        (is_trusted ? static_cast<int>(level) << 2 : 0) | votes);
  }
  TSAR_HD static bool IsTrusted(uint8_t rating) { return rating >> 2 != 0; }
  // In (0, 1] where it is trusted, otherwise 0.
  TSAR_HD static float Score(uint8_t rating) {
    return static_cast<float>(rating >> 2) / kMaxScore;
  }
  TSAR_HD static int Confirmations(uint8_t rating) { return rating & 3; }
  TSAR_HD static uint8_t WithoutTrust(uint8_t rating) { return rating & 3; }
};

}  // namespace tsar
