// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/occlusion_votes.h"

#include "colmap_tsar/compose/depth_confidence.h"

#include <memory>
#include <vector>

#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 80;
constexpr int kHeight = 60;
constexpr float kWall = 4.f;
constexpr Rgb kGray = {100, 100, 100};

// A wall that faces the reference and sources to its right, each of which sees
// it by the planes of its only superpixel.
class OcclusionVotesTest : public testing::Test {
 protected:
  explicit OcclusionVotesTest(int num_sources = 3) : evidence_(4) {
    for (size_t i = 0; i < evidence_.size(); ++i) {
      ViewEvidence& evidence = evidence_[i];
      evidence.width = kWidth;
      evidence.height = kHeight;
      evidence.superpixels = Image<uint16_t>(kWidth, kHeight);
      evidence.confident_depth = Image<float>(kWidth, kHeight);
      evidence.color = Image<Rgb>(kWidth, kHeight, kGray);
      Camera camera;
      camera.width = kWidth;
      camera.height = kHeight;
      camera.fx = camera.fy = 80.0;
      camera.cx = 0.5 * (kWidth - 1);
      camera.cy = 0.5 * (kHeight - 1);
      camera.translation.x() = -0.1 * static_cast<double>(i);
      views_.push_back({&evidence, camera});
    }
    for (int j = 0; j < num_sources; ++j) {
      planes_.push_back({Plane{{0.f, 0.f, -1.f}, kWall}});
    }
  }

  // The votes on the middle of the image, if it had this depth.
  OcclusionVotes VotesOn(float depth) const {
    const Image<float> depths(kWidth, kHeight, depth);
    const DeviceImage<float> on_device(*device_, depths);
    const auto votes = CountOcclusionVotes({views_, planes_},
                                           views_[0].camera.GetIntrinsics(),
                                           {on_device.View()},
                                           *device_);
    return votes[0].ToHost()(kWidth / 2, kHeight / 2);
  }

  static void Expect(const OcclusionVotes& votes,
                     int agreeing,
                     int in_front,
                     int behind) {
    EXPECT_EQ(votes.agreeing, agreeing);
    EXPECT_EQ(votes.in_front, in_front);
    EXPECT_EQ(votes.behind, behind);
  }

  const std::unique_ptr<Device> device_ = CreateTestDevice(2);
  std::vector<ViewEvidence> evidence_;
  std::vector<ObservedView> views_;
  std::vector<std::vector<Plane>> planes_;
};

TEST_F(OcclusionVotesTest, ViewsAgreeWithASurfaceAndContradictOthersBothWays) {
  Expect(VotesOn(kWall), 3, 0, 0);
  Expect(VotesOn(1.01f * kWall), 3, 0, 0);
  // Neither the same surface nor clearly two.
  Expect(VotesOn(1.03f * kWall), 0, 0, 0);
  Expect(VotesOn(1.1f * kWall), 0, 3, 0);
  Expect(VotesOn(0.9f * kWall), 0, 0, 3);
  Expect(VotesOn(0.f), 0, 0, 0);
}

TEST_F(OcclusionVotesTest, WhatASourceMeasuredCountsForItsPlane) {
  evidence_[2].confident_depth = Image<float>(kWidth, kHeight, 0.8f * kWall);
  Expect(VotesOn(kWall), 2, 1, 0);
  Expect(VotesOn(0.8f * kWall), 1, 0, 2);
}

TEST_F(OcclusionVotesTest, ASpeckInFrontHidesNothing) {
  planes_[0][0] = {};
  planes_[1][0] = {};
  Image<float>& measured = evidence_[3].confident_depth;
  // Where the source sees a point 2 in front of the middle.
  const int x = kWidth / 2 - 12;
  measured(x, kHeight / 2) = 2.f;
  Expect(VotesOn(kWall), 1, 0, 0);
  for (int j = -3; j <= 3; ++j) {
    for (int i = -3; i <= 3; ++i) {
      measured(x + i, kHeight / 2 + j) = 2.f;
    }
  }
  EXPECT_EQ(VotesOn(kWall).in_front, 1);
}

TEST(MeasurementSupportTest, WhatSpeaksForADepthRaisesItsOdds) {
  const MeasurementSupport support = {{2, 1, 1}, 5.f, false};
  const Rival plane = {{2, 1, 1}, 5.f, 0.3f};
  const float odds = LogOddsAgainst(plane, support);
  MeasurementSupport more = support;
  more.votes.agreeing = 6;
  EXPECT_GT(LogOddsAgainst(plane, more), odds);
  more = support;
  more.is_trusted = true;
  EXPECT_GT(LogOddsAgainst(plane, more), odds);
  for (const OcclusionVotes& votes :
       {OcclusionVotes{2, 5, 1}, OcclusionVotes{2, 1, 5}}) {
    MeasurementSupport less = support;
    less.votes = votes;
    EXPECT_LT(LogOddsAgainst(plane, less), odds);
  }
  // Evidence for the plane is evidence against the measurement.
  Rival better = plane;
  better.votes = {6, 0, 0};
  EXPECT_LT(LogOddsAgainst(better, support), odds);
  better = plane;
  better.margin = 0.8f;
  EXPECT_LT(LogOddsAgainst(better, support), odds);
  // The views see through the plane.
  Rival worse = plane;
  worse.votes = {0, 0, 6};
  EXPECT_GT(LogOddsAgainst(worse, support), odds);
}

// A red post, narrower than its parallax against the wall.
TEST_F(OcclusionVotesTest, ColorsFitWhatIsThinAndNotTheWallBehindIt) {
  constexpr float kPost = 2.f;
  for (size_t i = 0; i < evidence_.size(); ++i) {
    const int middle = kWidth / 2 - static_cast<int>(4 * i);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = middle - 1; x <= middle + 1; ++x) {
        evidence_[i].color(x, y) = {140, 100, 100};
      }
    }
  }
  const OcclusionVotes on_post = VotesOn(kPost);
  const OcclusionVotes on_wall = VotesOn(kWall);
  EXPECT_EQ(on_post.color, 0);
  EXPECT_EQ(on_post.second_color, 0);
  EXPECT_EQ(on_wall.second_color, OcclusionVotes::kNoColor - 1);
  EXPECT_GT(MisfitOf(on_wall, on_post), 0.4f);
  EXPECT_EQ(MisfitOf(on_post, on_wall), -MisfitOf(on_wall, on_post));
}

TEST_F(OcclusionVotesTest, ColorsOfWhatHidesAPointDoNotCount) {
  for (size_t j = 1; j < evidence_.size(); ++j) {
    evidence_[j].confident_depth = Image<float>(kWidth, kHeight, 0.5f * kWall);
    evidence_[j].color = Image<Rgb>(kWidth, kHeight, Rgb{0, 0, 0});
  }
  EXPECT_EQ(VotesOn(kWall).color, OcclusionVotes::kNoColor);
}

}  // namespace
}  // namespace tsar
