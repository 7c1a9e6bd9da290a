// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/bilateral_ncc.h"

#include "colmap_tsar/base/random.h"

#include "tests/base/drawn_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kSize = 32;

Image<float> DrawNoise(uint32_t seed) {
  Image<float> gray(kSize, kSize);
  Philox random(seed, 0, 0);
  for (float& value : gray) {
    value = 60.f + 100.f * random.NextFloat();
  }
  return gray;
}

// Maps every pixel to one that lies shift to the right.
PlaneHomography Shift(float shift) {
  const Intrinsics intrinsics{50.f, 50.f, 16.f, 16.f};
  RelativePose pose;
  pose.rotation = {{1.f, 0.f, 0.f}, {0.f, 1.f, 0.f}, {0.f, 0.f, 1.f}};
  pose.translation = {shift / 50.f, 0.f, 0.f};
  return PlaneHomography(
      intrinsics, intrinsics, pose, DrawnPlane({0.f, 0.f, -1.f}, 1.f));
}

float CostAt(const Image<float>& first,
             const Image<float>& second,
             int x,
             int y,
             float shift = 0.f) {
  const ReferencePatch patch(first.View(), x, y);
  return PatchCost(patch, Shift(shift), second.View());
}

TEST(PatchCost, IsZeroForTheSameWindow) {
  const Image<float> gray = DrawNoise(1);
  for (const int x : {0, 5, 16, 31}) {
    EXPECT_NEAR(CostAt(gray, gray, x, 16), 0.f, 1e-4f) << x;
  }
}

TEST(PatchCost, IgnoresBrightnessAndContrast) {
  const Image<float> gray = DrawNoise(1);
  Image<float> changed = DrawNoise(1);
  for (float& value : changed) {
    value = 0.4f * value + 70.f;
  }
  EXPECT_NEAR(CostAt(gray, changed, 16, 16), 0.f, 1e-4f);
}

TEST(PatchCost, IsTwoForTheNegative) {
  const Image<float> gray = DrawNoise(1);
  Image<float> negative = DrawNoise(1);
  for (float& value : negative) {
    value = 255.f - value;
  }
  const float cost = CostAt(gray, negative, 16, 16);
  EXPECT_NEAR(cost, 2.f, 1e-4f);
  EXPECT_LE(cost, 2.f);
}

TEST(PatchCost, IsAboutOneForUnrelatedWindows) {
  float sum = 0.f;
  for (uint32_t seed = 0; seed < 100; ++seed) {
    sum += CostAt(DrawNoise(2 * seed), DrawNoise(2 * seed + 1), 16, 16);
  }
  EXPECT_NEAR(sum / 100.f, 1.f, 0.1f);
}

TEST(PatchCost, FollowsTheHomography) {
  const Image<float> gray = DrawNoise(1);
  Image<float> shifted(kSize, kSize, 100.f);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 3; x < kSize; ++x) {
      shifted(x, y) = gray(x - 3, y);
    }
  }
  EXPECT_NEAR(CostAt(gray, shifted, 12, 16, 3.f), 0.f, 1e-3f);
  EXPECT_GT(CostAt(gray, shifted, 12, 16, 0.f), 0.3f);
}

TEST(PatchCost, IsUndefinedWithoutTextureOnEitherSide) {
  const Image<float> gray = DrawNoise(1);
  const Image<float> flat(kSize, kSize, 128.f);
  EXPECT_EQ(CostAt(flat, gray, 16, 16), kUndefinedCost);
  EXPECT_EQ(CostAt(gray, flat, 16, 16), kUndefinedCost);
  EXPECT_EQ(CostAt(flat, flat, 16, 16), kUndefinedCost);
}

TEST(PatchCost, TakesQuantisationForNoTexture) {
  Image<float> quantised(kSize, kSize);
  Philox random(5, 0, 0);
  for (float& value : quantised) {
    value = 128.f + random.NextBelow(2);
  }
  EXPECT_EQ(CostAt(quantised, quantised, 16, 16), kUndefinedCost);
}

TEST(PatchCost, IsUndefinedOutsideTheOtherImage) {
  const Image<float> gray = DrawNoise(1);
  EXPECT_NE(CostAt(gray, gray, 16, 16, 15.f), kUndefinedCost);
  EXPECT_EQ(CostAt(gray, gray, 16, 16, 16.f), kUndefinedCost);
  EXPECT_EQ(CostAt(gray, gray, 16, 16, -17.f), kUndefinedCost);
}

TEST(ReferencePatch, HasARadiusOfFiveByDefault) {
  const Image<float> gray = DrawNoise(1);
  const ReferencePatch by_default(gray.View(), 16, 12);
  const ReferencePatch five(gray.View(), 16, 12, 5.f);
  EXPECT_EQ(five.radius, kPatchRadius);
  EXPECT_EQ(five.step, 2.f);
  EXPECT_EQ(five.mean, by_default.mean);
  EXPECT_EQ(five.variance, by_default.variance);
  for (int i = 0; i < kPatchSize; ++i) {
    ASSERT_EQ(five.OffsetX(i), by_default.OffsetX(i));
    ASSERT_EQ(five.OffsetY(i), by_default.OffsetY(i));
    ASSERT_EQ(five.value[i], by_default.value[i]);
    ASSERT_EQ(five.weight[i], by_default.weight[i]);
  }
  // Every second pixel of 11 x 11.
  EXPECT_EQ(five.OffsetX(0), -5.f);
  EXPECT_EQ(five.OffsetX(1), -3.f);
  EXPECT_EQ(five.OffsetY(kPatchSize - 1), 5.f);
}

// An image twice as large whose pixels of even column and row are those of the
// other; the rest are noise.
Image<float> SpreadOut(const Image<float>& gray) {
  Image<float> spread(2 * kSize, 2 * kSize);
  Philox random(9, 0, 0);
  for (float& value : spread) {
    value = 255.f * random.NextFloat();
  }
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      spread(2 * x, 2 * y) = gray(x, y);
    }
  }
  return spread;
}

TEST(ReferencePatch, SamplesTwiceAsFarWithTwiceTheRadius) {
  const Image<float> gray = DrawNoise(1);
  const Image<float> spread = SpreadOut(gray);
  const ReferencePatch patch(gray.View(), 16, 12);
  const ReferencePatch wide(spread.View(), 32, 24, 10.f);
  EXPECT_EQ(wide.OffsetX(0), -10.f);
  EXPECT_EQ(wide.OffsetY(kPatchSize - 1), 10.f);
  for (int i = 0; i < kPatchSize; ++i) {
    ASSERT_EQ(wide.OffsetX(i), 2.f * patch.OffsetX(i));
    ASSERT_EQ(wide.OffsetY(i), 2.f * patch.OffsetY(i));
    ASSERT_EQ(wide.value[i], patch.value[i]);
    // The weights are spread like the samples.
    ASSERT_FLOAT_EQ(wide.weight[i], patch.weight[i]);
  }
  EXPECT_FLOAT_EQ(wide.mean, patch.mean);
  EXPECT_FLOAT_EQ(wide.variance, patch.variance);
}

TEST(PatchCost, MapsTheWindowOfThePatch) {
  const Image<float> gray = DrawNoise(1);
  const Image<float> other = DrawNoise(2);
  const float cost = CostAt(gray, other, 16, 12, 1.f);
  const Image<float> spread = SpreadOut(gray);
  const Image<float> other_spread = SpreadOut(other);
  const ReferencePatch wide(spread.View(), 32, 24, 10.f);
  EXPECT_NEAR(PatchCost(wide, Shift(2.f), other_spread.View()), cost, 1e-3f);
  const ReferencePatch narrow(spread.View(), 32, 24);
  EXPECT_GT(std::abs(PatchCost(narrow, Shift(2.f), other_spread.View()) - cost),
            1e-2f);
}

TEST(SampleBilinear, InterpolatesAndRepeatsTheBorder) {
  Image<float> gray(2, 2);
  gray(1, 0) = 10.f;
  gray(0, 1) = 20.f;
  gray(1, 1) = 30.f;
  const ImageView<const float> view = std::as_const(gray).View();
  EXPECT_FLOAT_EQ(SampleBilinear(view, 0.5f, 0.f), 5.f);
  EXPECT_FLOAT_EQ(SampleBilinear(view, 0.5f, 0.5f), 15.f);
  EXPECT_FLOAT_EQ(SampleBilinear(view, 1.f, 1.f), 30.f);
  EXPECT_FLOAT_EQ(SampleBilinear(view, -3.f, 9.f), 20.f);
}

}  // namespace
}  // namespace tsar
