// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/view/filter/confirmation.h"

#include <cstdint>

namespace tsar {

// The reliability of a measured depth, in one byte: whether it is trusted (bit
// 7), and whether another view confirms it (bit 6) on distinct texture (bit 5).
struct MeasurementFlags {
  static constexpr int kTrusted = 1 << 7;
  static constexpr int kConfirmed = 1 << 6;
  static constexpr int kDistinctTexture = 1 << 5;

  TSAR_HD static uint8_t Pack(bool is_trusted, Confirmation confirmation) {
    return static_cast<uint8_t>((is_trusted ? kTrusted : 0) |
                                BitsOf(confirmation));
  }
  TSAR_HD static bool IsTrusted(uint8_t flags) {
    return (flags & kTrusted) != 0;
  }
  TSAR_HD static bool IsConfirmed(uint8_t flags) {
    return (flags & kConfirmed) != 0;
  }
  TSAR_HD static bool IsConfirmedDistinctly(uint8_t flags) {
    return (flags & BitsOf(Confirmation::kDistinct)) ==
           BitsOf(Confirmation::kDistinct);
  }

 private:
  TSAR_HD static int BitsOf(Confirmation confirmation) {
    return confirmation == Confirmation::kNone ? 0
           : confirmation == Confirmation::kWeak
               ? kConfirmed
               : kConfirmed | kDistinctTexture;
  }
};

}  // namespace tsar
