// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/color_regions.h"

#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kSize = 8;  // The side of a superpixel.
constexpr int kNumColumns = 6;
constexpr int kNumRows = 4;
constexpr int kWidth = kNumColumns * kSize;
constexpr int kHeight = kNumRows * kSize;

// An image in squares, each of which is a superpixel.
ViewEvidence Draw(const std::function<int(int x, int y)>& gray) {
  ViewEvidence evidence;
  evidence.width = kWidth;
  evidence.height = kHeight;
  evidence.weights.assign(kNumColumns * kNumRows, 0.f);
  evidence.superpixels = SquareSuperpixels<uint16_t>(kWidth, kHeight, kSize);
  evidence.color = Image<Rgb>(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto level = static_cast<uint8_t>(gray(x, y));
      evidence.color(x, y) = {level, level, level};
    }
  }
  return evidence;
}

bool IsLeft(int superpixel) {
  return superpixel % kNumColumns < kNumColumns / 2;
}

// By level, whether the halves are apart.
void ExpectHalves(const std::vector<ColorRegions>& levels,
                  const std::vector<bool>& are_apart) {
  ASSERT_EQ(levels.size(), are_apart.size());
  for (size_t i = 0; i < levels.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(levels[i].count, are_apart[i] ? 2 : 1);
    for (int s = 0; s < kNumColumns * kNumRows; ++s) {
      EXPECT_EQ(levels[i].of_superpixel[s], are_apart[i] && !IsLeft(s) ? 1 : 0);
    }
  }
}

std::vector<ColorRegions> RegionsOf(const ViewEvidence& evidence) {
  return FindColorRegions({&evidence, {}});
}

TEST(ColorRegionsTest, AStepSeparatesUntilItIsTooSmallForTheLevel) {
  // Over three channels, a step of one level is 1.7.
  const auto halves = [](int step) {
    return RegionsOf(
        Draw([&](int x, int) { return x < kWidth / 2 ? 100 : 100 + step; }));
  };
  ExpectHalves(halves(0), {false, false, false});
  ExpectHalves(halves(1), {false, false, false});
  ExpectHalves(halves(2), {true, false, false});
  ExpectHalves(halves(4), {true, true, false});
  ExpectHalves(halves(5), {true, true, true});
}

TEST(ColorRegionsTest, AShadedWallIsOneRegion) {
  const std::vector<ColorRegions> levels =
      RegionsOf(Draw([](int x, int y) { return 50 + (x + y) / 3; }));
  for (const ColorRegions& regions : levels) {
    EXPECT_EQ(regions.count, 1);
  }
}

TEST(ColorRegionsTest, ALevelIsMadeOfTheRegionsOfTheOneBefore) {
  uint32_t state = 1;
  std::vector<int> grays;
  for (int s = 0; s < kNumColumns * kNumRows; ++s) {
    state = state * 1664525u + 1013904223u;
    grays.push_back(100 + static_cast<int>(state >> 28));
  }
  const std::vector<ColorRegions> levels = RegionsOf(Draw([&](int x, int y) {
    return grays[y / kSize * kNumColumns + x / kSize];
  }));
  for (size_t i = 1; i < levels.size(); ++i) {
    EXPECT_LE(levels[i].count, levels[i - 1].count);
    std::set<std::pair<int, int>> pairs;
    for (size_t s = 0; s < grays.size(); ++s) {
      pairs.emplace(levels[i - 1].of_superpixel[s], levels[i].of_superpixel[s]);
    }
    EXPECT_EQ(static_cast<int>(pairs.size()), levels[i - 1].count);
  }
  EXPECT_GT(levels.front().count, levels.back().count);
}

TEST(ColorRegionsTest, NoRegionCrossesACrease) {
  ViewEvidence evidence = Draw([](int, int) { return 100; });
  ObservedView view{&evidence, {}};
  for (int s = 0; s < evidence.NumSuperpixels(); ++s) {
    view.sides.push_back(IsLeft(s) ? 3 : 5);
  }
  ExpectHalves(FindColorRegions(view), {true, true, true});
}

}  // namespace
}  // namespace tsar
