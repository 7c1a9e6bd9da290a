// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/label_votes.h"

#include <memory>

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;
constexpr int kSize = 10;  // The side of a superpixel.
constexpr int kNumColumns = kWidth / kSize;
constexpr int kNumSuperpixels = kNumColumns * kHeight / kSize;
constexpr float kPixels = kSize * kSize;
// One pixel of disparity is 0.025 at this depth.
constexpr float kDepth = 5.f;

Plane WallAt(float depth) { return DrawnPlane({0.f, 0.f, -1.f}, depth); }

constexpr float kGain = 0.1f;  // For each view, up to kMaxSame of them.
constexpr float kMaxSame = 3.f;
constexpr float kCostOfRival = 0.1f;
constexpr float kCostOfHiding = 0.1f;
constexpr float kCostOfHidden = 0.2f;
constexpr float kGuessedWeight = 0.2f;

// A reference and sources that look at the same walls, each from its place.
class LabelVotesTest : public testing::Test {
 protected:
  LabelVotesTest() {
    evidence_.width = kWidth;
    evidence_.height = kHeight;
    evidence_.resolution.error_per_depth = 0.001f;
    evidence_.weights.assign(kNumSuperpixels, 0.f);
    evidence_.superpixels = SquareSuperpixels<uint16_t>(kWidth, kHeight, kSize);
    camera_ = SyntheticCamera(kWidth, kHeight, 40.0);
    views_.push_back({&evidence_, camera_});
  }

  // shift: of its place to the right.
  void AddSource(int label, float strength = 1.f, double shift = 0.0) {
    Camera camera = camera_;
    camera.translation.x() -= shift;
    views_.push_back({&evidence_, camera});
    ViewLabels& labels = labels_.emplace_back();
    labels.planes.assign(kNumSuperpixels, label);
    labels.strengths.assign(kNumSuperpixels, strength);
  }

  // The vote on each pixel of a superpixel.
  float Vote(int plane, int superpixel = 5) const {
    const std::unique_ptr<Device> device = Device::CreateCpu(2);
    const LabelInputs inputs(
        views_, {/*confident_depth=*/false, /*superpixels=*/true}, *device);
    return ComputeLabelVotes(inputs, planes_, labels_, *device)(plane,
                                                                superpixel) /
           kPixels;
  }

  ViewEvidence evidence_;
  Camera camera_;
  std::vector<ObservedView> views_;
  std::vector<ViewLabels> labels_;
  // The third is near the first, the others are far in front and behind.
  std::vector<Plane> planes_ = {WallAt(kDepth),
                                WallAt(3.f),
                                WallAt(kDepth + 0.0075f),
                                WallAt(8.f),
                                WallAt(kDepth - 0.1f)};
};

TEST_F(LabelVotesTest, TheSamePlaneGains) {
  AddSource(0);
  EXPECT_NEAR(Vote(0), -kGain, 1e-5f);
  AddSource(0);
  EXPECT_NEAR(Vote(0), -2.f * kGain, 1e-5f);
  for (int i = 0; i < 5; ++i) {
    AddSource(0);
  }
  EXPECT_NEAR(Vote(0), -kMaxSame * kGain, 1e-5f);
}

TEST_F(LabelVotesTest, AnotherPlaneNearbyIsARival) {
  AddSource(0);
  // 0.3 pixels of disparity, and more than 6 pixels lie between.
  EXPECT_NEAR(Vote(2), 0.6f * kCostOfRival, 1e-3f);
  EXPECT_NEAR(Vote(4), kCostOfRival, 1e-5f);
}

TEST_F(LabelVotesTest, NothingIsInFrontOfWhatAViewSees) {
  AddSource(0);
  EXPECT_NEAR(Vote(1), kCostOfHiding, 1e-5f);
  // What lies behind may be hidden from it.
  EXPECT_EQ(Vote(3), 0.f);
}

TEST_F(LabelVotesTest, NothingLiesBehindWhatSeveralViewsSee) {
  AddSource(0);
  AddSource(0);
  EXPECT_NEAR(Vote(3), 2.f * kCostOfHidden, 1e-5f);
  EXPECT_NEAR(Vote(1), 2.f * kCostOfHiding, 1e-5f);
  // A label that was not measured hides nothing.
  labels_[1].strengths.assign(kNumSuperpixels, 0.3f);
  EXPECT_EQ(Vote(3), 0.f);
}

TEST_F(LabelVotesTest, LabelsCountByHowFirmlyTheyWereMeasured) {
  AddSource(0, 0.5f);
  const float half = 0.5f + 0.5f * kGuessedWeight;
  EXPECT_NEAR(Vote(0), -half * kGain, 1e-5f);
  EXPECT_NEAR(Vote(1), half * kCostOfHiding, 1e-5f);
  labels_[0].strengths.assign(kNumSuperpixels, 0.f);
  EXPECT_NEAR(Vote(0), -kGuessedWeight * kGain, 1e-5f);
}

TEST_F(LabelVotesTest, ViewsWithoutAPlaneThereSayNothing) {
  AddSource(-1, 0.f);
  // Far to the right: nothing of the reference is in its image.
  AddSource(0, 1.f, 50.0);
  // Behind everything.
  AddSource(0);
  views_.back().camera.translation.z() -= 20.0;
  for (int plane = 0; plane < 5; ++plane) {
    EXPECT_EQ(Vote(plane), 0.f) << plane;
  }
}

TEST_F(LabelVotesTest, LooksAtThePlaceWhereTheSourceSeesThePoint) {
  // At this depth the source sees a point one superpixel further left.
  AddSource(3, 1.f, kSize * kDepth / 40.0);
  for (int row = 0; row < kHeight / kSize; ++row) {
    labels_[0].planes[row * kNumColumns + 1] = 0;
  }
  EXPECT_NEAR(Vote(0, kNumColumns + 2), -kGain, 1e-5f);
  EXPECT_NEAR(Vote(0, kNumColumns + 3), kCostOfHiding, 1e-5f);
}

}  // namespace
}  // namespace tsar
