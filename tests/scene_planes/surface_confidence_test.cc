// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/surface_confidence.h"

#include <array>

#include <gtest/gtest.h>

namespace tsar {
namespace {

std::array<float, 2> Values(const SurfaceConfidence& confidence) {
  return {confidence.moved, confidence.filled};
}

LabelQuality Quality(float margin, float uncertainty = 0.1f) {
  LabelQuality quality;
  quality.explained = ByteOf<0, 1>(0.9f);
  quality.strength = ByteOf<0, 1>(0.9f);
  quality.confirmed = ByteOf<0, 1>(0.5f);
  quality.uncertainty = ByteOf<0, 1>(uncertainty);
  quality.margin = ByteOf<-1, 2>(margin);
  return quality;
}

using Share = ByteOf<0, 1>;
using Margin = ByteOf<-1, 2>;

TEST(ByteOfTest, KeepsItsRangeToHalfAStep) {
  EXPECT_EQ(Margin().Value(), 0.f);
  EXPECT_EQ(Share(1.f).Value(), 1.f);
  EXPECT_EQ(Share(-7.f).Value(), 0.f);
  EXPECT_EQ(Margin(-1.f).Value(), -1.f);
  EXPECT_EQ(Margin(7.f).Value(), 2.f);
  for (int i = -1000; i <= 2000; ++i) {
    const float value = 0.001f * static_cast<float>(i);
    EXPECT_NEAR(Margin(value).Value(), value, 0.5001f * 3.f / 255.f);
  }
}

TEST(SurfaceConfidenceTest, ValuesAreProbabilities) {
  for (const float margin : {-1.f, 0.f, 2.f}) {
    for (const float uncertainty : {0.f, 1.f}) {
      for (const float value : Values(RateSurface(
               LabelEvidence::kGuessed, Quality(margin, uncertainty)))) {
        EXPECT_GE(value, 0.01f);
        EXPECT_LE(value, 0.99f);
      }
    }
  }
}

TEST(SurfaceConfidenceTest, GrowsWithTheMarginAndFallsWithTheUncertainty) {
  for (const LabelEvidence evidence :
       {LabelEvidence::kGuessed, LabelEvidence::kMeasured}) {
    const SurfaceConfidence clear = RateSurface(evidence, Quality(0.5f));
    const SurfaceConfidence close = RateSurface(evidence, Quality(0.02f));
    EXPECT_GT(clear.moved, close.moved);
    EXPECT_GT(clear.filled, close.filled);
    const SurfaceConfidence known = RateSurface(evidence, Quality(0.1f));
    const SurfaceConfidence unknown = RateSurface(evidence, Quality(0.1f, 1.f));
    EXPECT_GE(known.moved, unknown.moved);
    EXPECT_GT(known.filled, unknown.filled);
  }
}

TEST(SurfaceConfidenceTest, WhatWasMeasuredIsWorthMoreThanAGuess) {
  const SurfaceConfidence clear =
      RateSurface(LabelEvidence::kMeasured, Quality(0.6f));
  EXPECT_GT(clear.moved, 0.9f);
  EXPECT_GT(clear.filled, 0.9f);
  LabelQuality guessed = Quality(0.02f, 0.6f);
  guessed.explained = guessed.strength = guessed.confirmed = ByteOf<0, 1>(0.f);
  EXPECT_LT(RateSurface(LabelEvidence::kGuessed, guessed).filled, 0.3f);
}

}  // namespace
}  // namespace tsar
