// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/patch_match_steps.cuh"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kNumDraws = 10000;
constexpr DepthBounds kBounds{2.f, 50.f};

// The ray of a pixel far from the middle.
const Vec3f kRay = {0.7f, -0.5f, 1.f};

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

constexpr int kSize = 64;
constexpr int kMiddle = 32;

std::vector<PixelOffset> OffsetsOf(int area) {
  std::vector<PixelOffset> offsets;
  if (area < 4) {
    for (int i = 0; i < kNearAreaSize; ++i) {
      offsets.push_back(Turned(NearAreaOffset(i), area));
    }
  } else {
    for (int i = 0; i < kFarAreaSize; ++i) {
      offsets.push_back(Turned(FarAreaOffset(i), area - 4));
    }
  }
  return offsets;
}

bool FindBest(
    const Image<float>& costs, int x, int y, int area, PixelOffset* best) {
  return BestOfArea(costs.View(), x, y, area, best);
}

TEST(PropagationAreas, HaveDistinctMembersAndDoNotOverlap) {
  std::set<std::pair<int, int>> members;
  for (int area = 0; area < kNumPropagationAreas; ++area) {
    for (const PixelOffset& offset : OffsetsOf(area)) {
      EXPECT_TRUE(members.insert({offset.x, offset.y}).second)
          << area << ": " << offset.x << ", " << offset.y;
    }
  }
  EXPECT_EQ(members.size(), 4u * (7u + 11u));
}

TEST(BestOfArea, FindsTheLowestCostWhereverItIs) {
  for (int area = 0; area < kNumPropagationAreas; ++area) {
    const std::vector<PixelOffset> offsets = OffsetsOf(area);
    for (const PixelOffset& offset : offsets) {
      // Pixels outside of all areas cost less than any inside.
      Image<float> costs(kSize, kSize, 0.f);
      float cost = 1.f;
      for (const PixelOffset& member : offsets) {
        costs(kMiddle + member.x, kMiddle + member.y) = cost;
        cost += 0.01f;
      }
      costs(kMiddle + offset.x, kMiddle + offset.y) = 0.5f;
      PixelOffset best = {-1, -1};
      ASSERT_TRUE(FindBest(costs, kMiddle, kMiddle, area, &best));
      EXPECT_EQ(best.x, kMiddle + offset.x) << area;
      EXPECT_EQ(best.y, kMiddle + offset.y) << area;
    }
  }
}

TEST(BestOfArea, TakesWhatOfTheAreaIsInTheImage) {
  Image<float> costs(kSize, kSize);
  ForEachPixel(kSize, kSize, [&](int x, int y) {
    costs(x, y) = static_cast<float>(x + y);
  });
  for (int y = 0; y < kSize; ++y) {
    for (int area = 0; area < kNumPropagationAreas; ++area) {
      PixelOffset best = {-1, -1};
      if (FindBest(costs, 2, y, area, &best)) {
        ASSERT_TRUE(costs.Contains(best.x, best.y)) << area << ", row " << y;
      }
    }
  }
  // The far strip upwards from row 10 ends with row 1.
  PixelOffset best;
  ASSERT_TRUE(FindBest(costs, 2, 10, 4, &best));
  EXPECT_EQ(best.x, 2);
  EXPECT_EQ(best.y, 1);
}

int WeightOf(const std::vector<float>& costs, int iteration = 0) {
  ViewWeight weight(iteration);
  for (const float cost : costs) {
    weight.Add(cost);
  }
  return weight.Get();
}

TEST(ViewWeight, GetsStricterWithTheIterations) {
  // 0.8 exp(-t^2 / 90): 0.8, 0.791, 0.765, 0.724, 0.670, 0.606.
  const float bounds[] = {0.8f, 0.7912f, 0.7652f, 0.7239f, 0.6697f, 0.6060f};
  for (int iteration = 0; iteration < 6; ++iteration) {
    const float bound = bounds[iteration];
    EXPECT_GT(WeightOf(std::vector<float>(9, bound - 1e-3f), iteration), 0)
        << iteration;
    EXPECT_EQ(WeightOf(std::vector<float>(9, bound + 1e-3f), iteration), 0)
        << iteration;
  }
}

}  // namespace
}  // namespace tsar
