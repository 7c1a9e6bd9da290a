// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/propagation_areas.cuh"

#include <algorithm>
#include <cstdlib>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

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

int Reach(const std::vector<PixelOffset>& offsets) {
  int reach = 0;
  for (const PixelOffset& offset : offsets) {
    reach = std::max({reach, std::abs(offset.x), std::abs(offset.y)});
  }
  return reach;
}

bool FindBest(
    const Image<float>& costs, int x, int y, int area, PixelOffset* best) {
  return BestOfArea(costs.View(), x, y, area, best);
}

TEST(PropagationAreas, HoldPixelsOfTheOtherColor) {
  for (int area = 0; area < kNumPropagationAreas; ++area) {
    for (const PixelOffset& offset : OffsetsOf(area)) {
      EXPECT_EQ((std::abs(offset.x) + std::abs(offset.y)) % 2, 1)
          << area << ": " << offset.x << ", " << offset.y;
    }
  }
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

TEST(PropagationAreas, ReachAsFarAsTheyShould) {
  for (int area = 0; area < kNumPropagationAreas; ++area) {
    EXPECT_EQ(Reach(OffsetsOf(area)), area < 4 ? 4 : 23) << area;
  }
}

TEST(PropagationAreas, LieInFourDirections) {
  // Up, right, down and left.
  const PixelOffset directions[] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  for (int area = 0; area < kNumPropagationAreas; ++area) {
    const PixelOffset& direction = directions[area % 4];
    for (const PixelOffset& offset : OffsetsOf(area)) {
      const int along = offset.x * direction.x + offset.y * direction.y;
      const int across = offset.x * direction.y - offset.y * direction.x;
      EXPECT_GT(along, std::abs(across)) << area;
    }
  }
}

TEST(BestOfArea, FindsTheLowestCostWhereverItIs) {
  for (int area = 0; area < kNumPropagationAreas; ++area) {
    const std::vector<PixelOffset> offsets = OffsetsOf(area);
    for (const PixelOffset& offset : offsets) {
      // Pixels of no area, which cost less than all.
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

TEST(BestOfArea, TakesTheFirstOfEqualOnes) {
  const Image<float> costs(kSize, kSize, 1.f);
  for (int area = 0; area < kNumPropagationAreas; ++area) {
    const PixelOffset first = OffsetsOf(area).front();
    PixelOffset best = {-1, -1};
    ASSERT_TRUE(FindBest(costs, kMiddle, kMiddle, area, &best));
    EXPECT_EQ(best.x, kMiddle + first.x) << area;
    EXPECT_EQ(best.y, kMiddle + first.y) << area;
  }
}

TEST(BestOfArea, FindsNothingOutsideTheImage) {
  const Image<float> costs(kSize, kSize, 1.f);
  // In the corners two of the four directions lead out of the image.
  for (int area = 0; area < kNumPropagationAreas; ++area) {
    const int turns = area % 4;
    PixelOffset best;
    EXPECT_EQ(FindBest(costs, 0, 0, area, &best), turns == 1 || turns == 2);
    EXPECT_EQ(FindBest(costs, kSize - 1, kSize - 1, area, &best),
              turns == 0 || turns == 3);
  }
  const Image<float> pixel(1, 1, 1.f);
  for (int area = 0; area < kNumPropagationAreas; ++area) {
    PixelOffset best;
    EXPECT_FALSE(FindBest(pixel, 0, 0, area, &best)) << area;
  }
}

TEST(BestOfArea, TakesWhatOfTheAreaIsInTheImage) {
  Image<float> costs(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      costs(x, y) = static_cast<float>(x + y);
    }
  }
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

}  // namespace
}  // namespace tsar
