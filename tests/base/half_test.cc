// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/half.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Half, HasTheBitsOfIeee754) {
  EXPECT_EQ(ToPositiveHalf(1.f), 0x3c00);
  EXPECT_EQ(ToPositiveHalf(1.5f), 0x3e00);
  EXPECT_EQ(ToPositiveHalf(0.1f), 0x2e66);
  EXPECT_EQ(ToPositiveHalf(65504.f), 0x7bff);
  EXPECT_EQ(ToPositiveHalf(std::ldexp(1.f, -14)), 0x0400);
  EXPECT_EQ(ToPositiveHalf(std::ldexp(1.f, -15)), 0x0200);
}

TEST(Half, ClampsWhatItCannotHold) {
  EXPECT_EQ(ToPositiveHalf(1e-30f), 0x0001);
  EXPECT_EQ(ToPositiveHalf(1e6f), 0x7bff);
  EXPECT_EQ(ToPositiveHalf(std::numeric_limits<float>::infinity()), 0x7bff);
}

TEST(Half, EveryNumberComesBack) {
  for (int bits = 1; bits <= 0x7bff; ++bits) {
    const float value = HalfToFloat(static_cast<uint16_t>(bits));
    ASSERT_EQ(ToPositiveHalf(value), bits);
    // And is the nearest to what is less than half a step beside it.
    const float next =
        bits < 0x7bff ? HalfToFloat(static_cast<uint16_t>(bits + 1)) : value;
    ASSERT_EQ(ToPositiveHalf(0.51f * value + 0.49f * next), bits);
    ASSERT_EQ(ToPositiveHalf(0.49f * value + 0.51f * next),
              bits < 0x7bff ? bits + 1 : bits);
  }
  EXPECT_EQ(HalfToFloat(0), 0.f);
}

}  // namespace
}  // namespace tsar
