// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tests/scene/evidence/gather_evidence_fixture.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(GatherEvidenceTest, BordersAreWeakWhereTheImageHasAnEdge) {
  // Only on one side of the border between 1 and 2.
  Fill(&inputs_.contrast, 2, 8.f);
  const ViewEvidence evidence = Gather();
  EXPECT_NEAR(BorderOf(evidence, 0, 1).weight, kSize * 2.05f, 1e-3f);
  EXPECT_NEAR(BorderOf(evidence, 0, 4).weight, kSize * 2.05f, 1e-3f);
  const float at_edge = kSize * (0.05f + 2.f * std::exp(-2.f));
  EXPECT_NEAR(BorderOf(evidence, 1, 2).weight, at_edge, 1e-3f);
  EXPECT_NEAR(BorderOf(evidence, 2, 3).weight, at_edge, 1e-3f);
  EXPECT_NEAR(BorderOf(evidence, 2, 6).weight, at_edge, 1e-3f);
}

TEST_F(GatherEvidenceTest, BordersAreSortedAndHoldEachPairOnce) {
  for (const bool is_reversed : {false, true}) {
    for (int& label : inputs_.superpixels) {
      label = is_reversed ? kNumSuperpixels - 1 - label : label;
    }
    const ViewEvidence evidence = Gather();
    // Between columns and between rows.
    EXPECT_EQ(evidence.borders.size(), 3u * 3u + 4u * 2u);
    for (size_t i = 0; i < evidence.borders.size(); ++i) {
      const SuperpixelBorder& border = evidence.borders[i];
      EXPECT_LT(border.first, border.second);
      if (i > 0) {
        const SuperpixelBorder& last = evidence.borders[i - 1];
        EXPECT_LT(std::pair(last.first, last.second),
                  std::pair(border.first, border.second));
      }
    }
  }
}

TEST_F(GatherEvidenceTest, BordersKeepPixelsOnTheSideOfTheFirst) {
  const std::array<int, 4> spaced = {1, 3, 6, 8};
  const ViewEvidence evidence = Gather();
  for (int i = 0; i < SuperpixelBorder::kNumPixels; ++i) {
    EXPECT_EQ(BorderOf(evidence, 0, 1).pixels[i], spaced[i] * kWidth + 9);
    EXPECT_EQ(BorderOf(evidence, 0, 4).pixels[i], 9 * kWidth + spaced[i]);
  }
  for (int& label : inputs_.superpixels) {
    label = kNumSuperpixels - 1 - label;
  }
  const ViewEvidence reversed = Gather();
  for (int i = 0; i < SuperpixelBorder::kNumPixels; ++i) {
    EXPECT_EQ(BorderOf(reversed, 10, 11).pixels[i], spaced[i] * kWidth + 10);
    EXPECT_EQ(BorderOf(reversed, 7, 11).pixels[i], 10 * kWidth + spaced[i]);
  }
}

TEST_F(GatherEvidenceTest, ShortBordersRepeatTheirPixels) {
  std::fill(inputs_.superpixels.begin(), inputs_.superpixels.end(), 0);
  inputs_.superpixels(0, 0) = 1;
  inputs_.num_superpixels = 2;
  inputs_.superpixel_planes.resize(2);
  const ViewEvidence evidence = Gather();
  ASSERT_EQ(evidence.borders.size(), 1u);
  for (const int pixel : evidence.borders[0].pixels) {
    EXPECT_TRUE(pixel == 1 || pixel == kWidth) << pixel;
  }
}

}  // namespace
}  // namespace tsar
