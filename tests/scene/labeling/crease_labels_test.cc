// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/crease_labels.h"

#include <cmath>

#include "tests/scene/creases/drawn_wall_fixture.h"

namespace tsar {
namespace {

// Where the wall ends and the ceiling begins.
constexpr double kCrease = -1.0;
constexpr float kPixels = 100.f;  // Of a superpixel.

class CreaseLabelsTest : public DrawnWallTest {
 protected:
  CreaseLabelsTest()
      : camera_(CameraAt({0.2, 0.05, 0.0})), evidence_(BareEvidence(camera_)) {
    ceiling_ = AddPlane({0.0, 1.0, 0.0}, {0.0, kCrease, 4.0}, 1, 0.0);
    other_ = AddPlane({0.0, 0.0, -1.0}, {0.0, 0.0, 8.0}, 2, 500.0);
    BoundingCrease crease;
    crease.plane = 0;
    crease.beyond = ceiling_;
    crease.limit = model_.planes[ceiling_].plane;
    creases_ = {crease};
  }

  void AddVotes(const std::vector<int>& indices,
                const Image<PlaneCost>& costs,
                Image<float>* votes) const {
    AddCreaseVotes({&evidence_, camera_},
                   model_.planes,
                   indices,
                   creases_,
                   costs,
                   options_,
                   votes);
  }

  // Whether the middle of a superpixel shows what is above the crease.
  bool IsBeyond(int superpixel) const {
    const double x = (superpixel % kNumColumns + 0.5) * kSuperpixelSize - 0.5;
    const double y = (superpixel / kNumColumns + 0.5) * kSuperpixelSize - 0.5;
    return OnWall(camera_, x, y).y() < kCrease;
  }

  // Of the three planes.
  Image<float> Votes(const Image<PlaneCost>& costs) const {
    Image<float> votes;
    AddVotes({0, ceiling_, other_}, costs, &votes);
    return votes;
  }
  Image<float> Votes() const {
    return Votes(Image<PlaneCost>(3, kNumSuperpixels));
  }

  Camera camera_;
  ViewEvidence evidence_;
  std::vector<BoundingCrease> creases_;
  int ceiling_ = -1;
  int other_ = -1;
  LabelOptions options_;
};

TEST_F(CreaseLabelsTest, BeyondTheCreaseTheWallIsCostlyAndTheCeilingIsNot) {
  const Image<float> votes = Votes();
  ASSERT_EQ(votes.Width(), 3);
  ASSERT_EQ(votes.Height(), kNumSuperpixels);
  int num_beyond = 0;
  for (int s = 0; s < kNumSuperpixels; ++s) {
    SCOPED_TRACE(s);
    if (IsBeyond(s)) {
      ++num_beyond;
      EXPECT_FLOAT_EQ(votes(0, s), 0.3f * kPixels);
      EXPECT_FLOAT_EQ(votes(1, s), -options_.uncertainty_cost * kPixels);
      EXPECT_FLOAT_EQ(votes(2, s), 0.3f * kPixels);
    } else {
      EXPECT_EQ(votes(0, s), 0.f);
      EXPECT_FLOAT_EQ(votes(1, s), kPixels);
      EXPECT_EQ(votes(2, s), 0.f);
    }
  }
  EXPECT_GT(num_beyond, 30);
  EXPECT_LT(num_beyond, kNumSuperpixels / 2);
}

TEST_F(CreaseLabelsTest, PlanesThatSomethingSpeaksForMayStandBeyond) {
  Image<PlaneCost> costs(3, kNumSuperpixels);
  for (int s = 0; s < kNumSuperpixels; ++s) {
    costs(0, s).explained = 0.5f;
    (s % 2 == 0 ? costs(2, s).explained : costs(2, s).confirmed) = 0.5f;
  }
  const Image<float> votes = Votes(costs);
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(votes(2, s), 0.f) << s;
    // But not the one that ends there.
    EXPECT_FLOAT_EQ(votes(0, s), IsBeyond(s) ? 0.3f * kPixels : 0.f) << s;
  }
}

TEST_F(CreaseLabelsTest, WhatWasMeasuredOfThePlaneBeyondNeedsNoHelp) {
  creases_[0].is_new = false;
  const Image<float> votes = Votes();
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(votes(1, s), 0.f) << s;
    EXPECT_FLOAT_EQ(votes(0, s), IsBeyond(s) ? 0.3f * kPixels : 0.f) << s;
  }
}

// A cupboard before the wall, which begins on the floor, may hide the ceiling
// but not stand behind it.
TEST_F(CreaseLabelsTest, WhatBeginsElsewhereMayStandBeforeThePlaneBeyond) {
  constexpr double kFront = 3.0;
  const int floor = AddPlane({0.0, -1.0, 0.0}, {0.0, 1.0, 4.0}, 1, 500.0);
  const int front = AddPlane({0.0, 0.0, -1.0}, {0.0, 0.0, kFront}, 2, 500.0);
  BoundingCrease at_floor;
  at_floor.plane = floor;
  at_floor.beyond = front;
  at_floor.limit = model_.planes[front].plane;
  at_floor.is_new = false;
  const auto votes_on_front = [&] {
    Image<float> votes;
    AddVotes({ceiling_, front}, Image<PlaneCost>(2, kNumSuperpixels), &votes);
    std::vector<float> column;
    for (int s = 0; s < kNumSuperpixels; ++s) {
      column.push_back(votes(1, s));
    }
    return column;
  };
  const std::vector<float> without = votes_on_front();
  creases_.push_back(at_floor);
  const std::vector<float> with = votes_on_front();
  const Eigen::Vector3d center = camera_.Center();
  int num_before = 0;
  int num_behind = 0;
  for (int s = 0; s < kNumSuperpixels; ++s) {
    SCOPED_TRACE(s);
    const auto i = static_cast<size_t>(s);
    if (!IsBeyond(s)) {
      EXPECT_EQ(with[i], 0.f);
      continue;
    }
    EXPECT_FLOAT_EQ(without[i], 0.3f * kPixels);
    const double x = (s % kNumColumns + 0.5) * kSuperpixelSize - 0.5;
    const double y = (s / kNumColumns + 0.5) * kSuperpixelSize - 0.5;
    const Eigen::Vector3d ray = OnWall(camera_, x, y) - center;
    const bool is_before =
        (center + ray * (kFront - center.z()) / ray.z()).y() > kCrease;
    EXPECT_FLOAT_EQ(with[i], is_before ? 0.f : 0.3f * kPixels);
    ++(is_before ? num_before : num_behind);
  }
  EXPECT_GT(num_before, 0);
  EXPECT_GT(num_behind, 10);
}

TEST_F(CreaseLabelsTest, APlaneThatIsAlmostTheOneBeyondIsNotCostly) {
  const auto votes_on = [&](double angle, double height) {
    const int plane = AddPlane(
        {0.0, std::cos(angle), std::sin(angle)}, {0.0, height, 4.0}, -1, 500.0);
    Image<float> votes;
    AddVotes({ceiling_, plane}, Image<PlaneCost>(2, kNumSuperpixels), &votes);
    return votes;
  };
  ASSERT_TRUE(IsBeyond(0));
  const Image<float> almost = votes_on(0.01, kCrease - 0.005);
  const Image<float> tilted = votes_on(0.06, kCrease);
  const Image<float> higher = votes_on(0.0, kCrease - 0.1);
  for (int s = 0; s < kNumSuperpixels; ++s) {
    SCOPED_TRACE(s);
    const float costly = IsBeyond(s) ? 0.3f * kPixels : 0.f;
    EXPECT_EQ(tilted(1, s), costly);
    EXPECT_EQ(higher(1, s), costly);
  }
  // Seen at a flat angle, a small turn is much in depth.
  EXPECT_EQ(almost(1, 0), 0.f);
}

TEST_F(CreaseLabelsTest, PosterAndWallEndAtOneCreaseThatCountsOnce) {
  creases_.push_back(creases_[0]);
  creases_[1].plane = AddPlane({0.0, 0.0, -1.0}, {0.0, 0.0, 4.98}, 2, 100.0);
  const Image<float> votes = Votes();
  for (int s = 0; s < kNumSuperpixels; ++s) {
    const float costly = IsBeyond(s) ? 0.3f * kPixels : 0.f;
    EXPECT_FLOAT_EQ(votes(0, s), costly) << s;
    EXPECT_FLOAT_EQ(votes(2, s), costly) << s;
  }
}

TEST_F(CreaseLabelsTest, VotesOfOtherViewsStay) {
  Image<float> votes(3, kNumSuperpixels, 7.f);
  AddVotes({0, ceiling_, other_}, Image<PlaneCost>(3, kNumSuperpixels), &votes);
  const Image<float> alone = Votes();
  for (size_t i = 0; i < votes.NumPixels(); ++i) {
    EXPECT_FLOAT_EQ(votes.Data()[i], alone.Data()[i] + 7.f);
  }
}

TEST_F(CreaseLabelsTest, ACameraAboveTheCeilingSeesNothingBeyond) {
  camera_ = CameraAt({0.2, -1.5, 0.0});
  evidence_ = BareEvidence(camera_);
  const Image<float> votes = Votes();
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(votes(0, s), 0.f) << s;
    EXPECT_FLOAT_EQ(votes(1, s), kPixels) << s;
  }
}

}  // namespace
}  // namespace tsar
