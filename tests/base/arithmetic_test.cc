// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/arithmetic.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

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

TEST(ExpOfNegative, FallsFromOneToZero) {
  EXPECT_EQ(ExpOfNegative(0.f), 1.f);
  EXPECT_EQ(ExpOfNegative(-std::numeric_limits<float>::denorm_min()), 1.f);
  EXPECT_EQ(ExpOfNegative(-86.f), 0.f);
  EXPECT_EQ(ExpOfNegative(-std::numeric_limits<float>::infinity()), 0.f);
}

TEST(NaturalLogarithm, IsThatOfTheLibrary) {
  for (float x = 1e-30f; x < 1e30f; x *= 1.37f) {
    EXPECT_NEAR(
        NaturalLogarithm(x), std::log(x), 3e-7 * (1. + std::abs(std::log(x))))
        << x;
  }
  EXPECT_EQ(NaturalLogarithm(1.f), 0.f);
}

TEST(Half, HasTheBitsOfIeee754) {
  EXPECT_EQ(ToPositiveHalf(1.f), 0x3c00);
  EXPECT_EQ(ToPositiveHalf(1.5f), 0x3e00);
  EXPECT_EQ(ToPositiveHalf(0.1f), 0x2e66);
  EXPECT_EQ(ToPositiveHalf(65504.f), 0x7bff);
  EXPECT_EQ(ToPositiveHalf(std::ldexp(1.f, -14)), 0x0400);
  EXPECT_EQ(ToPositiveHalf(std::ldexp(1.f, -15)), 0x0200);
  EXPECT_EQ(ToPositiveHalf(1e-30f), 0x0001);
  EXPECT_EQ(ToPositiveHalf(1e6f), 0x7bff);
  EXPECT_EQ(ToPositiveHalf(std::numeric_limits<float>::infinity()), 0x7bff);
}

TEST(Half, EveryNumberComesBack) {
  for (int bits = 1; bits <= 0x7bff; ++bits) {
    const float value = HalfToFloat(static_cast<uint16_t>(bits));
    ASSERT_EQ(ToPositiveHalf(value), bits);
    // Floats within half a step of the value are rounded to it.
    const float next =
        bits < 0x7bff ? HalfToFloat(static_cast<uint16_t>(bits + 1)) : value;
    ASSERT_EQ(ToPositiveHalf(0.51f * value + 0.49f * next), bits);
    ASSERT_EQ(ToPositiveHalf(0.49f * value + 0.51f * next),
              bits < 0x7bff ? bits + 1 : bits);
  }
  EXPECT_EQ(HalfToFloat(0), 0.f);
}

TEST(Half, ReadsNegativeAndSpecialNumbers) {
  EXPECT_EQ(HalfToFloat(0xc000), -2.f);
  EXPECT_EQ(HalfToFloat(0x8001), -kMinHalf);
  EXPECT_EQ(HalfToFloat(0x7c00), std::numeric_limits<float>::infinity());
  EXPECT_EQ(HalfToFloat(0xfc00), -std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(HalfToFloat(0x7c01)));
}

TEST(RoundToInt, IsThatOfTheLibrary) {
  for (int eighths = -400; eighths <= 400; ++eighths) {
    const float value = static_cast<float>(eighths) / 8.f;
    EXPECT_EQ(RoundToInt(value), std::lround(value)) << value;
    EXPECT_EQ(RoundToInt(1000.f * value), std::lround(1000.f * value));
  }
}

std::array<uint32_t, 4> NextBlock(Philox* random) {
  std::array<uint32_t, 4> block;
  for (uint32_t& number : block) {
    number = random->Next();
  }
  return block;
}

// Computed by another implementation, which reproduces the published vectors of
// Philox4x32-10.
TEST(Philox, GivesTheKnownBlocksOfItsKeyAndCounter) {
  Philox zero(0, 0, 0);
  EXPECT_EQ(NextBlock(&zero),
            (std::array<uint32_t, 4>{
                0x56f58efb, 0x0638d02b, 0x6e175f77, 0x5a977ce8}));
  EXPECT_EQ(NextBlock(&zero),
            (std::array<uint32_t, 4>{
                0x9ec3cf4a, 0x40c1c09a, 0x579cdab9, 0x0d8ec92a}));
  Philox digits_of_pi(0xa4093822, 0x85a308d3, 0x13198a2e);
  EXPECT_EQ(NextBlock(&digits_of_pi),
            (std::array<uint32_t, 4>{
                0xb0d36cc6, 0x40cebb66, 0xf10c15e2, 0x7162a764}));
}

TEST(Philox, GivesEachDrawSiteItsOwnStream) {
  std::vector<std::array<uint32_t, 4>> blocks;
  for (uint32_t image = 0; image < 8; ++image) {
    for (uint32_t region = 0; region < 8; ++region) {
      for (uint32_t iteration = 0; iteration < 8; ++iteration) {
        for (uint32_t seed = 0; seed < 4; ++seed) {
          Philox random(image, region, iteration, seed);
          blocks.push_back(NextBlock(&random));
          blocks.push_back(NextBlock(&random));
        }
      }
    }
  }
  std::sort(blocks.begin(), blocks.end());
  EXPECT_EQ(std::adjacent_find(blocks.begin(), blocks.end()), blocks.end());
}

TEST(Philox, StaysBelowItsBound) {
  for (const uint32_t bound : {1u, 2u, 3u, 1000u, 0x80000001u, 0xffffffffu}) {
    Philox random(1, 2, bound);
    for (int i = 0; i < 1000; ++i) {
      ASSERT_LT(random.NextBelow(bound), bound);
    }
  }
}

TEST(Philox, IsUniform) {
  constexpr int kBins = 10;
  constexpr int kDraws = 100000;
  std::array<int, kBins> integers = {};
  std::array<int, kBins> floats = {};
  Philox random(3, 1, 4);
  for (int i = 0; i < kDraws; ++i) {
    ++integers[random.NextBelow(kBins)];
    const float value = random.NextFloat();
    ASSERT_GE(value, 0.f);
    ASSERT_LT(value, 1.f);
    ++floats[static_cast<int>(value * kBins)];
  }
  // Five standard deviations of a bin: sqrt(1e5 * 0.1 * 0.9) = 95.
  for (int bin = 0; bin < kBins; ++bin) {
    EXPECT_NEAR(integers[bin], kDraws / kBins, 475) << bin;
    EXPECT_NEAR(floats[bin], kDraws / kBins, 475) << bin;
  }
}

}  // namespace
}  // namespace tsar
