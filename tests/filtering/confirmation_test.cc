// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/filtering/confirmation.h"

#include <memory>
#include <utility>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kSize = 16;
// A variance of 1 at every level.
constexpr NoiseCurve kNoise{1.f, 0.f};

// Bare in the left half; columns of +- `contrast` levels in the right one.
Image<float> HalfTextured(float contrast) {
  Image<float> gray(kSize, kSize, 100.f);
  for (int y = 0; y < kSize; ++y) {
    for (int x = kSize / 2; x < kSize; ++x) {
      gray(x, y) += x % 2 == 0 ? contrast : -contrast;
    }
  }
  return gray;
}

Image<uint8_t> Count(const Image<float>& gray,
                     const Image<uint8_t>& agreement,
                     const Image<uint8_t>& is_candidate,
                     const NoiseCurve& noise = kNoise) {
  const std::unique_ptr<Device> device = Device::CreateCpu(2);
  return CountConfirmations(gray.View(),
                            agreement.View(),
                            is_candidate.View(),
                            noise,
                            {},
                            *device)
      .ToHost();
}

TEST(CountConfirmations, CountsViewsWhereThePixelHasTexture) {
  Image<uint8_t> agreement(kSize, kSize, 2);
  agreement(12, 5) = 0;
  agreement(13, 5) = 1;
  const Image<uint8_t> counts = Count(HalfTextured(4.f), agreement, {});
  EXPECT_EQ(counts(2, 5), 0);
  EXPECT_EQ(counts(5, 5), 0) << "The texture begins three pixels beside it.";
  EXPECT_EQ(counts(6, 5), 2) << "Two columns of texture are its own.";
  EXPECT_EQ(counts(12, 5), 0);
  EXPECT_EQ(counts(13, 5), 1);
  EXPECT_EQ(counts(15, 0), 2) << "The window is cut by the border.";
}

TEST(CountConfirmations, MeasuresTextureInUnitsOfTheNoise) {
  const Image<uint8_t> agreement(kSize, kSize, 3);
  // Its variance is 1: that of the noise.
  EXPECT_EQ(Count(HalfTextured(1.f), agreement, {})(12, 8), 0);
  EXPECT_EQ(Count(HalfTextured(1.f), agreement, {}, {0.25f, 0.f})(12, 8), 3);
  // More light, more noise.
  EXPECT_EQ(Count(HalfTextured(4.f), agreement, {}, {0.f, 0.01f})(12, 8), 3);
  EXPECT_EQ(Count(HalfTextured(4.f), agreement, {}, {0.f, 0.16f})(12, 8), 0);
}

TEST(CountConfirmations, LeavesOutWhatCannotBeConfirmed) {
  const Image<uint8_t> agreement(kSize, kSize, 3);
  Image<uint8_t> is_candidate(kSize, kSize, 1);
  is_candidate(12, 8) = 0;
  const Image<uint8_t> counts =
      Count(HalfTextured(4.f), agreement, is_candidate);
  EXPECT_EQ(counts(12, 8), 0);
  EXPECT_EQ(counts(13, 8), 3);
}

}  // namespace
}  // namespace tsar
