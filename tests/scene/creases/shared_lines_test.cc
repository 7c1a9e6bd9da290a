// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/shared_lines.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr float kPixel = 0.04f;

PlaneLine LineAt(float place,
                 float step = 2.f,
                 int plane = 0,
                 int axis = 1,
                 float pixel = kPixel) {
  return {plane, axis, place, pixel, step};
}

TEST(JoinPlaneLines, ThreeViewsMakeALineAndTwoDoNot) {
  const std::vector<PlaneLine> lines =
      JoinPlaneLines({{LineAt(-1.f, 1.f), LineAt(0.5f)},
                      {LineAt(-1.02f, 2.f), LineAt(0.5f)},
                      {LineAt(-0.95f, 6.f)}});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].num_views, 3);
  EXPECT_EQ(lines[0].plane, 0);
  EXPECT_EQ(lines[0].axis, 1);
  EXPECT_NEAR(lines[0].position, -0.99f, 1e-6f);
  EXPECT_EQ(lines[0].pixel, kPixel);
  EXPECT_NEAR(lines[0].step, 3.f, 1e-6f);
}

TEST(JoinPlaneLines, LinesOfOneViewAreOneView) {
  EXPECT_TRUE(
      JoinPlaneLines({{LineAt(0.f), LineAt(0.01f), LineAt(0.02f)}, {}, {}})
          .empty());
}

TEST(JoinPlaneLines, LinesAreAtOnePlaceToAPixelAndAHalf) {
  const auto join = [](float gap) {
    return JoinPlaneLines({{LineAt(0.f)}, {LineAt(gap)}, {LineAt(2.f * gap)}});
  };
  EXPECT_EQ(join(1.4f * kPixel).size(), 1u);
  EXPECT_TRUE(join(1.6f * kPixel).empty());
}

TEST(JoinPlaneLines, OtherSignsPlanesAndAxesAreOtherLines) {
  for (const PlaneLine& other :
       {LineAt(0.f, -2.f), LineAt(0.f, 2.f, 1), LineAt(0.f, 2.f, 0, 0)}) {
    EXPECT_TRUE(
        JoinPlaneLines({{LineAt(0.f)}, {LineAt(0.f)}, {other}}).empty());
  }
}

TEST(JoinPlaneLines, WhatIsSeenFromNearCountsMore) {
  const std::vector<PlaneLine> lines =
      JoinPlaneLines({{LineAt(0.f, 2.f, 0, 1, 0.02f)},
                      {LineAt(0.05f, 2.f, 0, 1, 0.04f)},
                      {LineAt(0.05f, 2.f, 0, 1, 0.04f)}});
  ASSERT_EQ(lines.size(), 1u);
  // Weights 4, 1 and 1.
  EXPECT_NEAR(lines[0].position, 0.05f * 2.f / 6.f, 1e-6f);
  EXPECT_EQ(lines[0].pixel, 0.04f);
}

TEST(JoinPlaneLines, MostViewsComeFirstAndNoLineCountsTwice) {
  // Four views at 0; two of the three at 0.1 are among these.
  const std::vector<PlaneLine> lines =
      JoinPlaneLines({{LineAt(0.f)},
                      {LineAt(0.f)},
                      {LineAt(0.f), LineAt(0.17f)},
                      {LineAt(0.06f)},
                      {LineAt(0.14f)}});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].num_views, 4);
}

TEST(JoinPlaneLines, AreSortedByPlaneInAnyOrderOfTheLines) {
  const std::vector<std::vector<PlaneLine>> forward(3,
                                                    {LineAt(0.f),
                                                     LineAt(1.01f),
                                                     LineAt(1.f, -3.f),
                                                     LineAt(2.f, 1.f, 0, 0),
                                                     LineAt(1.f, 2.f, 4),
                                                     LineAt(1.02f, 2.f, 2)});
  std::vector<std::vector<PlaneLine>> backward = forward;
  for (std::vector<PlaneLine>& of_view : backward) {
    std::reverse(of_view.begin(), of_view.end());
  }
  const std::vector<PlaneLine> a = JoinPlaneLines(forward);
  const std::vector<PlaneLine> b = JoinPlaneLines(backward);
  ASSERT_EQ(a.size(), 6u);
  ASSERT_EQ(b.size(), 6u);
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].plane, b[i].plane);
    EXPECT_EQ(a[i].axis, b[i].axis);
    EXPECT_EQ(a[i].position, b[i].position);
    EXPECT_EQ(a[i].step, b[i].step);
    EXPECT_TRUE(i == 0 || a[i - 1].plane <= a[i].plane);
  }
}

}  // namespace
}  // namespace tsar
