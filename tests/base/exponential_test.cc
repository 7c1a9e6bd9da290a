// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/exponential.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(ExpOfNegative, IsTheExponentialToTheLastBits) {
  double largest = 0.0;
  for (int i = 0; i <= 840000; ++i) {
    const float x = -1e-4f * static_cast<float>(i);
    const double expected = std::exp(static_cast<double>(x));
    ASSERT_TRUE(std::isfinite(ExpOfNegative(x))) << x;
    largest = std::max(largest, std::abs(ExpOfNegative(x) / expected - 1.0));
  }
  EXPECT_LT(largest, 3e-7);
}

TEST(ExpOfNegative, IsOneAtZero) {
  EXPECT_EQ(ExpOfNegative(0.f), 1.f);
  EXPECT_EQ(ExpOfNegative(-0.f), 1.f);
  EXPECT_EQ(ExpOfNegative(-std::numeric_limits<float>::denorm_min()), 1.f);
}

TEST(ExpOfNegative, FallsToZero) {
  EXPECT_EQ(ExpOfNegative(-86.f), 0.f);
  EXPECT_EQ(ExpOfNegative(-1e30f), 0.f);
  EXPECT_EQ(ExpOfNegative(-std::numeric_limits<float>::infinity()), 0.f);
}

TEST(ExpOfNegative, NeverRises) {
  float last = 1.f;
  for (int i = 0; i <= 100000; ++i) {
    const float value = ExpOfNegative(-9e-4f * static_cast<float>(i));
    // But for rounding, which the seams of the pieces may show.
    ASSERT_LE(value, last * (1.f + 3e-7f)) << i;
    last = value;
  }
}

}  // namespace
}  // namespace tsar
