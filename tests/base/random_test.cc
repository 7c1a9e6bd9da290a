// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

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
