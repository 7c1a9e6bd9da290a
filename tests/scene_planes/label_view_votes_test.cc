// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/gather_evidence.h"
#include "colmap_tsar/scene_planes/label_view.h"

#include "tests/scene_planes/label_view_fixture.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(LabelViewTest, PlanesDoNotHideWhatOtherViewsSawThroughThem) {
  Measure(WallAt(3.f), 0, 2);
  AddSource([](int, int) { return 6.f; });
  // The measured ones are contradicted too, but only by one view.
  const LabeledView view = Label({WallAt(3.f)});
  for (int s = 0; s < kNumSuperpixels; ++s) {
    if (s % kNumColumns >= 3) {
      EXPECT_EQ(view.labels[s], -1);
      EXPECT_EQ(view.evidence[s], LabelEvidence::kNone);
    }
  }
  options_.cost_of_contradiction = 0.f;
  ExpectColumns(Label({WallAt(3.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(LabelViewTest, OnlyWhatLiesWellInFrontContradicts) {
  Measure(WallAt(3.f), 0, 2);
  // One pixel of disparity is 0.009 there.
  for (const float depth : {3.f + 1.3f * 0.009f, 2.5f, 0.f}) {
    AddSource([&](int, int) { return depth; });
    ExpectColumns(Label({WallAt(3.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
  }
  AddSource([](int, int) { return 3.f + 2.f * 0.009f; });
  EXPECT_EQ(Label({WallAt(3.f)}).labels[5], -1);
}

TEST_F(LabelViewTest, ViewsThatLookAwaySayNothing) {
  Measure(WallAt(3.f), 0, 2);
  AddSource([](int, int) { return 6.f; });
  source_turn_.diagonal() << -1.0, 1.0, -1.0;
  ExpectColumns(Label({WallAt(3.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(LabelViewTest, OtherViewsConfirmPlanes) {
  options_.unlabelled_cost = 0.f;
  DrawEdgesEverywhere();
  Measure(WallAt(3.f), 0, 2);
  ExpectColumns(Label({WallAt(3.f)}), {0, 0, 0, -1, -1, -1, -1, -1});
  // Columns 5 and 6 of the reference.
  AddSource([](int x, int) { return x >= 24 && x < 43 ? 3.001f : 0.f; });
  const LabeledView view = Label({WallAt(3.f)});
  ExpectColumns(view, {0, 0, 0, -1, -1, 0, 0, -1});
  EXPECT_EQ(view.evidence[5], LabelEvidence::kCarried);
  options_.gain_of_confirmation = 0.f;
  ExpectColumns(Label({WallAt(3.f)}), {0, 0, 0, -1, -1, -1, -1, -1});
}

TEST_F(LabelViewTest, TwoViewsSayMoreThanOneButThreeDoNot) {
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 7);
  const auto label = [&](float depth, int num_sources) {
    AddSource([&](int x, int) { return x < 60 ? depth : 0.f; });
    num_sources_ = num_sources;
    return Label({WallAt(5.f), WallAt(4.9f)}).labels[2 * kNumColumns + 3];
  };
  // Having no plane costs 0.6 here.
  options_.cost_of_contradiction = 0.7f;
  EXPECT_EQ(label(8.f, 1), 0);
  EXPECT_EQ(label(8.f, 2), -1);
  options_.cost_of_contradiction = 0.5f;
  EXPECT_EQ(label(8.f, 3), 0);
  // The nearer plane costs 1.
  options_.gain_of_confirmation = 1.2f;
  EXPECT_EQ(label(4.9f, 1), 0);
  EXPECT_EQ(label(4.9f, 2), 1);
  options_.gain_of_confirmation = 0.8f;
  EXPECT_EQ(label(4.9f, 3), 0);
}

TEST_F(LabelViewTest, TellsHowEachSuperpixelCameByItsPlane) {
  Measure(WallAt(3.f), 0, 2);
  DrawEdgeLeftOf(6);
  // Column 3 of the reference; 6 and 7 are seen through.
  AddSource([](int x, int) {
    return x >= 4 && x < 13 ? 3.f : x >= 34 ? 6.f : 0.f;
  });
  const LabeledView view = Label({WallAt(3.f)});
  ExpectColumns(view, {0, 0, 0, 0, 0, 0, -1, -1});
  ExpectEvidence(view,
                 {LabelEvidence::kMeasured,
                  LabelEvidence::kMeasured,
                  LabelEvidence::kMeasured,
                  LabelEvidence::kCarried,
                  LabelEvidence::kGuessed,
                  LabelEvidence::kGuessed,
                  LabelEvidence::kNone,
                  LabelEvidence::kNone});
}

TEST_F(LabelViewTest, PlanesFarFromAllDepthsAreImpossible) {
  DrawEdgesEverywhere();
  options_.uncertainty_cost = 0.f;
  Measure(WallAt(5.f), 0, 2);
  // From half the nearest depth to twice the farthest.
  ExpectColumns(Label({WallAt(9.9f)}), {-1, -1, -1, 0, 0, 0, 0, 0});
  ExpectColumns(Label({WallAt(2.6f)}), {-1, -1, -1, 0, 0, 0, 0, 0});
  ExpectColumns(Label({WallAt(10.1f)}), {-1, -1, -1, -1, -1, -1, -1, -1});
  ExpectColumns(Label({WallAt(2.4f)}), {-1, -1, -1, -1, -1, -1, -1, -1});
}

}  // namespace
}  // namespace tsar
