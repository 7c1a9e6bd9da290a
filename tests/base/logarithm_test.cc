// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/logarithm.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(NaturalLogarithm, IsThatOfTheLibrary) {
  for (float x = 1e-30f; x < 1e30f; x *= 1.37f) {
    EXPECT_NEAR(
        NaturalLogarithm(x), std::log(x), 3e-7 * (1. + std::abs(std::log(x))))
        << x;
  }
}

TEST(NaturalLogarithm, IsExactAtOne) { EXPECT_EQ(NaturalLogarithm(1.f), 0.f); }

}  // namespace
}  // namespace tsar
