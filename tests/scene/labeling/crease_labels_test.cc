// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/crease_labels.h"

#include <cmath>
#include <vector>

#include "tests/scene/creases/drawn_wall_fixture.h"

namespace tsar {
namespace {

// Where the wall ends and the ceiling begins.
constexpr double kCrease = -1.0;
constexpr float kPixels = 100.f;  // Per superpixel.

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

  void AddVotes(const std::vector<int>& indices, Image<float>* votes) {
    costs_ = Image<PlaneCost>(static_cast<int>(indices.size()),
                              kNumSuperpixels,
                              {.uncertainty = 1.f});
    AddCreaseVotes({&evidence_, camera_},
                   model_.planes,
                   indices,
                   creases_,
                   options_,
                   &costs_,
                   votes);
  }

  static Eigen::Vector3d Middle(const Camera& camera, int superpixel) {
    const double x = (superpixel % kNumColumns + 0.5) * kSuperpixelSize - 0.5;
    const double y = (superpixel / kNumColumns + 0.5) * kSuperpixelSize - 0.5;
    return OnWall(camera, x, y);
  }

  // Whether the middle of a superpixel shows what is above the crease.
  bool IsBeyond(int superpixel) const {
    return Middle(camera_, superpixel).y() < kCrease;
  }

  // The cost there of a plane, given its depth over that of the wall: the
  // ceiling hides it if it lies 1.5 % behind.
  float CostOfHidden(int superpixel, double depth_by_wall) const {
    const double height = camera_.Center().y() - kCrease;
    const double to_wall =
        camera_.Center().y() - Middle(camera_, superpixel).y();
    return IsBeyond(superpixel) && depth_by_wall * to_wall > 1.015 * height
               ? 0.3f * kPixels
               : 0.f;
  }

  // The votes for the three planes.
  Image<float> Votes() {
    Image<float> votes;
    AddVotes({0, ceiling_, other_}, &votes);
    return votes;
  }

  Camera camera_;
  ViewEvidence evidence_;
  std::vector<BoundingCrease> creases_;
  Image<PlaneCost> costs_;  // After the last votes.
  int ceiling_ = -1;
  int other_ = -1;
  LabelOptions options_;
};

TEST_F(CreaseLabelsTest, BeyondTheCreaseTheCeilingHidesWhatIsBehindIt) {
  const Image<float> votes = Votes();
  ASSERT_EQ(votes.Width(), 3);
  ASSERT_EQ(votes.Height(), kNumSuperpixels);
  int num_hidden = 0;
  for (int s = 0; s < kNumSuperpixels; ++s) {
    SCOPED_TRACE(s);
    EXPECT_FLOAT_EQ(votes(0, s), CostOfHidden(s, 1.0));
    EXPECT_FLOAT_EQ(votes(2, s), CostOfHidden(s, 8.0 / kDistance));
    num_hidden += votes(0, s) > 0.f ? 1 : 0;
    if (IsBeyond(s)) {
      EXPECT_FLOAT_EQ(votes(1, s), -options_.uncertainty_cost * kPixels);
      EXPECT_EQ(costs_(1, s).uncertainty, 0.5f);
    } else {
      EXPECT_FLOAT_EQ(votes(1, s), kPixels);
      EXPECT_EQ(costs_(1, s).uncertainty, 1.f);
    }
    EXPECT_EQ(costs_(0, s).uncertainty, 1.f);
  }
  EXPECT_GT(num_hidden, 30);
  EXPECT_LT(num_hidden, kNumSuperpixels / 2);
}

// Posters and copies of the wall end with it, and a cupboard in front of the
// ceiling does not.
TEST_F(CreaseLabelsTest, WhatStandsBeforeTheCeilingStays) {
  const auto votes_on = [&](double z) {
    const int plane = AddPlane({0.0, 0.0, -1.0}, {0.0, 0.0, z}, 2, 100.0);
    Image<float> votes;
    AddVotes({ceiling_, plane}, &votes);
    return votes;
  };
  const Image<float> poster = votes_on(4.98);
  const Image<float> cupboard = votes_on(3.0);
  int num_before = 0;
  for (int s = 0; s < kNumSuperpixels; ++s) {
    SCOPED_TRACE(s);
    EXPECT_FLOAT_EQ(poster(1, s), CostOfHidden(s, 4.98 / kDistance));
    EXPECT_FLOAT_EQ(cupboard(1, s), CostOfHidden(s, 3.0 / kDistance));
    num_before += IsBeyond(s) && cupboard(1, s) == 0.f ? 1 : 0;
  }
  EXPECT_GT(num_before, 10);
}

// First the plane beyond was measured; then it is seen from above.
TEST_F(CreaseLabelsTest, PlanesBeyondAreHelpedOnlyWhereTheyAreNewAndSeen) {
  creases_[0].is_new = false;
  Image<float> votes = Votes();
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(votes(1, s), 0.f) << s;
    EXPECT_EQ(costs_(1, s).uncertainty, 1.f) << s;
    EXPECT_FLOAT_EQ(votes(0, s), CostOfHidden(s, 1.0)) << s;
  }
  creases_[0].is_new = true;
  camera_ = CameraAt({0.2, -1.5, 0.0});
  evidence_ = BareEvidence(camera_);
  votes = Votes();
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(votes(0, s), 0.f) << s;
    EXPECT_FLOAT_EQ(votes(1, s), kPixels) << s;
  }
}

TEST_F(CreaseLabelsTest, TheCreaseDividesTheImageInTwo) {
  const auto sides = [&] {
    return FindSidesOfCreases({&evidence_, camera_}, model_.planes, creases_);
  };
  const std::vector<int> divided = sides();
  ASSERT_EQ(divided.size(), static_cast<size_t>(kNumSuperpixels));
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(divided[s] != divided.back(), IsBeyond(s)) << s;
  }
  // Planes that were measured are known on both sides.
  creases_[0].is_new = false;
  EXPECT_EQ(sides(), std::vector<int>(kNumSuperpixels, 0));
}

}  // namespace
}  // namespace tsar
