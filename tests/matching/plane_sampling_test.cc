// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/plane_sampling.cuh"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kNumDraws = 10000;
constexpr DepthBounds kBounds{2.f, 50.f};

// Of a pixel far from the middle.
const Vec3f kRay = {0.7f, -0.5f, 1.f};

TEST(DepthBounds, ContainTheirEnds) {
  EXPECT_TRUE(kBounds.Contains(2.f));
  EXPECT_TRUE(kBounds.Contains(50.f));
  EXPECT_FALSE(kBounds.Contains(1.999f));
  EXPECT_FALSE(kBounds.Contains(50.01f));
  EXPECT_FALSE(kBounds.Contains(0.f));
  EXPECT_FALSE(kBounds.Contains(NAN));
}

TEST(DepthBounds, DrawsUniformlyInInverseDepth) {
  Philox random(1, 2, 3);
  std::array<int, 10> histogram = {};
  for (int i = 0; i < kNumDraws; ++i) {
    const float depth = kBounds.Draw(&random);
    ASSERT_GE(depth, 2.f * (1.f - 1e-6f));
    ASSERT_LE(depth, 50.f * (1.f + 1e-6f));
    const float t = (1.f / depth - 1.f / 50.f) / (1.f / 2.f - 1.f / 50.f);
    ++histogram[std::clamp(static_cast<int>(10.f * t), 0, 9)];
  }
  // Five standard deviations: sqrt(10000 * 0.1 * 0.9) = 30.
  for (const int count : histogram) {
    EXPECT_NEAR(count, kNumDraws / 10, 150);
  }
}

TEST(DepthBounds, DrawsAroundADepthWithinItsShare) {
  Philox random(1, 2, 3);
  const float range = 1.f / 2.f - 1.f / 50.f;
  for (const float share : {0.2f, 0.01f}) {
    float lowest = 1.f;
    float highest = -1.f;
    for (int i = 0; i < kNumDraws; ++i) {
      const float depth = kBounds.DrawAround(5.f, share, &random);
      const float step = (1.f / depth - 1.f / 5.f) / range;
      ASSERT_LE(std::abs(step), share + 1e-5f);
      lowest = std::min(lowest, step);
      highest = std::max(highest, step);
    }
    EXPECT_LT(lowest, -0.99f * share);
    EXPECT_GT(highest, 0.99f * share);
  }
}

TEST(DepthBounds, DrawsAroundADepthWithinTheBounds) {
  Philox random(1, 2, 3);
  for (const float center : {2.f, 2.1f, 40.f, 50.f}) {
    for (int i = 0; i < kNumDraws; ++i) {
      const float depth = kBounds.DrawAround(center, 0.5f, &random);
      ASSERT_GE(depth, 2.f * (1.f - 1e-6f));
      ASSERT_LE(depth, 50.f * (1.f + 1e-6f));
    }
  }
}

TEST(DrawNormal, FacesTheCameraEvenly) {
  Philox random(1, 2, 3);
  const Vec3f to_camera = Normalized(-kRay);
  std::array<int, 10> histogram = {};
  Vec3f sum = {};
  for (int i = 0; i < kNumDraws; ++i) {
    const Vec3f normal = DrawNormal(kRay, &random);
    ASSERT_NEAR(Norm(normal), 1.f, 1e-5f);
    const float cosine = Dot(normal, to_camera);
    ASSERT_GE(cosine, 0.f);
    ++histogram[std::min(static_cast<int>(10.f * cosine), 9)];
    sum = sum + normal;
  }
  // On a half sphere heights are uniform, and the mean is half the axis.
  for (const int count : histogram) {
    EXPECT_NEAR(count, kNumDraws / 10, 150);
  }
  EXPECT_LT(Norm(sum * (1.f / kNumDraws) - 0.5f * to_camera), 0.03f);
}

TEST(DrawNormalAround, StaysNearAndFacesTheCamera) {
  Philox random(1, 2, 3);
  const Vec3f normal = Normalized(Vec3f{0.2f, 0.3f, -1.f});
  for (const float turn : {0.5f, 0.05f}) {
    // The steps fill a cube, whose corners lie this far off.
    const float step = std::sqrt(3.f) * turn;
    const float limit = std::asin(std::min(step, 1.f)) * 57.29578f;
    float largest = 0.f;
    for (int i = 0; i < kNumDraws; ++i) {
      const Vec3f turned = DrawNormalAround(normal, turn, kRay, &random);
      ASSERT_NEAR(Norm(turned), 1.f, 1e-5f);
      ASSERT_LT(Dot(turned, kRay), 0.f);
      largest = std::max(largest, AngleBetween(turned, normal));
    }
    EXPECT_LE(largest, limit + 0.01f) << turn;
    EXPECT_GT(largest, 0.7f * limit) << turn;
  }
}

TEST(DrawNormalAround, KeepsTheNormalWhereItWouldTurnAway) {
  Philox random(1, 2, 3);
  // Nearly along the ray.
  const Vec3f across = Normalized(Cross(kRay, {0.f, 1.f, 0.f}));
  const Vec3f normal = Normalized(across - 1e-3f * kRay);
  ASSERT_LT(Dot(normal, kRay), 0.f);
  int num_kept = 0;
  for (int i = 0; i < kNumDraws; ++i) {
    const Vec3f turned = DrawNormalAround(normal, 0.3f, kRay, &random);
    ASSERT_LT(Dot(turned, kRay), 0.f);
    num_kept += turned == normal ? 1 : 0;
  }
  EXPECT_NEAR(num_kept, kNumDraws / 2, kNumDraws / 20);
}

TEST(PlaneSampling, DependsOnTheStreamAlone) {
  Philox first(4, 5, 6);
  Philox second(4, 5, 6);
  Philox other(4, 5, 7);
  const Vec3f normal = {0.f, 0.f, -1.f};
  int num_equal = 0;
  for (int i = 0; i < 100; ++i) {
    const float depth = kBounds.Draw(&first);
    ASSERT_EQ(depth, kBounds.Draw(&second));
    num_equal += depth == kBounds.Draw(&other) ? 1 : 0;
    ASSERT_EQ(kBounds.DrawAround(5.f, 0.1f, &first),
              kBounds.DrawAround(5.f, 0.1f, &second));
    ASSERT_EQ(DrawNormal(kRay, &first), DrawNormal(kRay, &second));
    ASSERT_EQ(DrawNormalAround(normal, 0.1f, kRay, &first),
              DrawNormalAround(normal, 0.1f, kRay, &second));
  }
  EXPECT_LT(num_equal, 5);
}

}  // namespace
}  // namespace tsar
