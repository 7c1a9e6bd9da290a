// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/bounding_creases.h"

#include <cmath>
#include <numeric>

#include "tests/support/scene_model_testing.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr float kPixel = 0.04f;

// A wall at z = 5 that cameras below y = -1 see; y points down, the frame is
// that of the world.
class BoundingCreasesTest : public testing::Test {
 protected:
  BoundingCreasesTest() {
    model_.frames.push_back(Eigen::Matrix3d::Identity());
    AddPlane({0.0, 0.0, -1.0}, {0.5, 0.0, 5.0}, 2, 1000.0);
  }

  int AddPlane(const Eigen::Vector3d& normal,
               const Eigen::Vector3d& center,
               int axis,
               double support) {
    return AddAlignedPlane(normal, center, axis, support, &model_);
  }

  // Evidence that nothing was measured beyond: above it, where y is smaller.
  static LineEvidence EndEvidence() {
    LineEvidence evidence;
    evidence.sides[0] = {1000.0, 0.0, 0.0, 3};
    evidence.sides[1] = {3000.0, 2000.0, 0.0, 0};
    return evidence;
  }
  static LineEvidence MeasuredOnBothSides() {
    LineEvidence evidence = EndEvidence();
    evidence.sides[0].measured = 900.0;
    return evidence;
  }

  void AddLine(float place,
               const LineEvidence& evidence = EndEvidence(),
               float step = 3.f,
               int plane = 0) {
    lines_.push_back({plane, 1, place, kPixel, step, 3});
    evidence_.push_back(evidence);
  }

  // Adds to the model.
  std::vector<BoundingCrease> Find(std::vector<int> copies = {}) {
    if (copies.empty()) {
      copies.resize(model_.planes.size());
      std::iota(copies.begin(), copies.end(), 0);
    }
    return FindBoundingCreases(lines_, evidence_, copies, &model_);
  }

  // There is one, at this height.
  void ExpectCreaseAt(double y) {
    const std::vector<BoundingCrease> creases = Find();
    ASSERT_EQ(creases.size(), 1u);
    EXPECT_NEAR(creases[0].limit.Height({0.0, y, 0.0}), 0.0, 1e-6);
  }

  SceneModel model_;
  std::vector<PlaneLine> lines_;
  std::vector<LineEvidence> evidence_;
};

TEST_F(BoundingCreasesTest, ACeilingBeginsWhereAWallEnds) {
  model_.planes[0].component = 4;
  AddLine(-1.f);
  const std::vector<BoundingCrease> creases = Find();
  ASSERT_EQ(creases.size(), 1u);
  EXPECT_EQ(creases[0].plane, 0);
  EXPECT_EQ(creases[0].beyond, 1);
  EXPECT_TRUE(creases[0].is_new);
  ASSERT_EQ(model_.planes.size(), 2u);
  const ModelPlane& ceiling = model_.planes[1];
  // Faces what is below.
  EXPECT_EQ(ceiling.plane.normal, Eigen::Vector3d(0.0, 1.0, 0.0));
  EXPECT_EQ(ceiling.plane.normal, creases[0].limit.normal);
  EXPECT_EQ(ceiling.plane.offset, creases[0].limit.offset);
  EXPECT_NEAR(ceiling.plane.Height({3.0, -1.0, 2.0}), 0.0, 1e-9);
  EXPECT_NEAR(
      (ceiling.center - Eigen::Vector3d(0.5, -1.0, 5.0)).norm(), 0.0, 1e-9);
  Eigen::Matrix3d axes;
  axes << ceiling.axis_s, ceiling.axis_t, ceiling.plane.normal;
  EXPECT_TRUE(axes.isUnitary(1e-12));
  EXPECT_NEAR(ceiling.covariance(2, 2), double{kPixel} * kPixel, 1e-9);
  EXPECT_EQ(ceiling.component, 4);
  EXPECT_EQ(ceiling.frame, 0);
  EXPECT_EQ(ceiling.axis, 1);
  EXPECT_EQ(ceiling.support, 0.0);
}

TEST_F(BoundingCreasesTest, AFloorBeginsOnTheOtherSide) {
  LineEvidence evidence = EndEvidence();
  std::swap(evidence.sides[0], evidence.sides[1]);
  AddLine(1.f, evidence);
  const std::vector<BoundingCrease> creases = Find();
  ASSERT_EQ(creases.size(), 1u);
  EXPECT_EQ(creases[0].limit.normal, Eigen::Vector3d(0.0, -1.0, 0.0));
  EXPECT_NEAR(creases[0].limit.Height({0.0, 0.0, 0.0}), 1.0, 1e-6);
}

// None where the plane continues, views see through the one that would begin,
// too few views show enough, or nothing was measured on this side either.
TEST_F(BoundingCreasesTest, NeedsEnoughEvidence) {
  AddLine(-1.f);
  const LineEvidence good = evidence_[0];
  using Side = LineEvidence::Side;
  const auto count_with = [&](size_t side, const auto& change) {
    evidence_[0] = good;
    change(evidence_[0].sides[side]);
    model_.planes.resize(1);
    return Find().size();
  };
  EXPECT_EQ(count_with(0, [](Side& side) { side.measured = 29.0; }), 1u);
  EXPECT_EQ(count_with(0, [](Side& side) { side.measured = 31.0; }), 0u);
  EXPECT_EQ(count_with(0, [](Side& side) { side.through = 29.0; }), 1u);
  EXPECT_EQ(count_with(0, [](Side& side) { side.through = 31.0; }), 0u);
  EXPECT_EQ(count_with(0, [](Side& side) { side.num_views = 2; }), 0u);
  EXPECT_EQ(count_with(0, [](Side& side) { side.area = 200.0; }), 0u);
  EXPECT_EQ(count_with(1, [](Side& side) { side.measured = 100.0; }), 0u);
  EXPECT_EQ(model_.planes.size(), 1u);
}

TEST_F(BoundingCreasesTest, TilesHaveNone) {
  AddLine(-1.f);
  AddLine(-0.5f, MeasuredOnBothSides());
  EXPECT_EQ(Find().size(), 1u);
  model_.planes.resize(1);
  AddLine(0.1f, MeasuredOnBothSides(), 2.2f);
  EXPECT_TRUE(Find().empty());
  // Fainter ones are not of the same kind as the crease,
  lines_.back().step = 2.f;
  EXPECT_EQ(Find().size(), 1u);
  model_.planes.resize(1);
  // and lines side by side, at most 14 pixels apart, are one.
  lines_.back().step = 2.2f;
  lines_.back().position = -0.5f + 13.9f * kPixel;
  EXPECT_EQ(Find().size(), 1u);
  model_.planes.resize(1);
  lines_.back().position = -0.5f + 14.1f * kPixel;
  EXPECT_TRUE(Find().empty());
}

TEST_F(BoundingCreasesTest, ASurfaceGoesOnAsLongAsItsLinesDo) {
  AddLine(-1.f);
  AddLine(-1.5f);
  AddLine(-0.8f);
  ExpectCreaseAt(-1.5);
}

TEST_F(BoundingCreasesTest, OfAFallAndARiseTheirMiddle) {
  AddLine(-1.2f, EndEvidence(), -2.f);
  AddLine(-1.f, EndEvidence(), 2.f);
  ExpectCreaseAt(-1.1);
}

TEST_F(BoundingCreasesTest, OfTwoFallsOrDistantLinesTheLast) {
  AddLine(-1.2f, EndEvidence(), 2.f);
  AddLine(-1.f, EndEvidence(), 2.f);
  ExpectCreaseAt(-1.2);
  // More than 14 pixels.
  lines_[1].step = -2.f;
  lines_[1].position = -0.6f;
  model_.planes.resize(1);
  ExpectCreaseAt(-1.2);
}

TEST_F(BoundingCreasesTest, TakesAPlaneThatLiesThereAndIsWellMeasured) {
  const int ceiling = AddPlane({0.0, 1.0, 0.0}, {2.0, -1.1, 3.0}, 1, 200.0);
  AddLine(-1.f);
  const std::vector<BoundingCrease> creases = Find();
  ASSERT_EQ(creases.size(), 1u);
  EXPECT_EQ(creases[0].beyond, ceiling);
  EXPECT_FALSE(creases[0].is_new);
  EXPECT_EQ(model_.planes.size(), 2u);
  // The wall ends at its line.
  EXPECT_NEAR(creases[0].limit.Height({0.0, -1.0, 0.0}), 0.0, 1e-6);
}

TEST_F(BoundingCreasesTest, OtherPlanesAreNotTaken) {
  AddLine(-1.f);
  const auto is_taken = [&](const ModelPlane& plane) {
    model_.planes.resize(1);
    model_.planes.push_back(plane);
    const std::vector<BoundingCrease> creases = Find();
    return creases.size() == 1 && creases[0].beyond == 1;
  };
  const ModelPlane ceiling =
      model_.planes[AddPlane({0.0, 1.0, 0.0}, {0.5, -1.0, 5.0}, 1, 200.0)];
  EXPECT_TRUE(is_taken(ceiling));
  ModelPlane other = ceiling;
  other.support = 99.0;  // A tenth of the wall's is required.
  EXPECT_FALSE(is_taken(other));
  other = ceiling;
  other.plane.offset += 0.6;  // More than ten pixels.
  EXPECT_FALSE(is_taken(other));
  other = ceiling;
  other.plane.normal *= -1.0;
  other.plane.offset *= -1.0;
  EXPECT_FALSE(is_taken(other));
  other = ceiling;
  other.component = 1;
  EXPECT_FALSE(is_taken(other));
  // It need not lie along the frame exactly: 3 degrees are 0.052.
  for (const double angle : {0.04, 0.06}) {
    other = ceiling;
    other.frame = other.axis = -1;
    other.plane.normal = {0.0, std::cos(angle), std::sin(angle)};
    other.plane.offset = -other.plane.normal.dot(other.center);
    EXPECT_EQ(is_taken(other), angle < 0.05);
  }
}

TEST_F(BoundingCreasesTest, OfSeveralPlanesTheOneThatIsMeasuredMost) {
  AddLine(-1.f);
  AddPlane({0.0, 1.0, 0.0}, {2.0, -1.05, 3.0}, 1, 200.0);
  const int most = AddPlane({0.0, 1.0, 0.0}, {2.0, -0.8, 3.0}, 1, 300.0);
  AddPlane({0.0, 1.0, 0.0}, {2.0, -1.1, 3.0}, 1, 250.0);
  const std::vector<BoundingCrease> creases = Find();
  ASSERT_EQ(creases.size(), 1u);
  EXPECT_EQ(creases[0].beyond, most);
}

TEST_F(BoundingCreasesTest, TwoWallsShareTheCeilingThatBothPropose) {
  AddPlane({-1.0, 0.0, 0.0}, {2.0, 0.5, 3.0}, 0, 800.0);
  AddLine(-1.f);
  AddLine(-1.55f, EndEvidence(), 3.f, 1);
  const std::vector<BoundingCrease> creases = Find();
  ASSERT_EQ(creases.size(), 2u);
  EXPECT_EQ(model_.planes.size(), 3u);
  EXPECT_EQ(creases[0].plane, 0);
  EXPECT_EQ(creases[1].plane, 1);
  EXPECT_EQ(creases[0].beyond, 2);
  EXPECT_EQ(creases[1].beyond, 2);
  // A view that shows only one of them knows as little about the ceiling.
  EXPECT_TRUE(creases[0].is_new);
  EXPECT_TRUE(creases[1].is_new);
}

// Two wings of a house, turned by a degree, far from the origin.
TEST_F(BoundingCreasesTest, ACeilingHoldsTheCreasesOfTwoFrames) {
  const Eigen::Vector3d origin(300.0, 20.0, 500.0);
  const Eigen::AngleAxisd turn(0.0175, Eigen::Vector3d::UnitZ());
  model_.frames.push_back(turn.toRotationMatrix());
  model_.planes.clear();
  AddPlane({0.0, 0.0, -1.0}, origin, 2, 1000.0);
  AddPlane({-1.0, 0.0, 0.0}, origin, 0, 800.0);
  ModelPlane& other = model_.planes.back();
  other.frame = 1;
  other.plane.normal = -model_.frames[1].col(0);
  other.plane.offset = -other.plane.normal.dot(origin);
  AddLine(-1.f);
  AddLine(-1.f, EndEvidence(), 3.f, 1);
  const std::vector<BoundingCrease> creases = Find();
  ASSERT_EQ(creases.size(), 2u);
  EXPECT_EQ(creases[1].beyond, creases[0].beyond);
  const ModelPlane& ceiling = model_.planes[creases[0].beyond];
  EXPECT_NEAR(
      ceiling.plane.Height(origin - Eigen::Vector3d::UnitY()), 0.0, 0.001);
  EXPECT_NEAR(ceiling.covariance(2, 2), double{kPixel} * kPixel, 1e-5);
}

// A strong edge on the wall that only some of the views see begins no plane,
// but a plane that was measured there is used.
TEST_F(BoundingCreasesTest, EdgesThatFewViewsSeeBeginNoNewPlane) {
  LineEvidence seen_by_many = EndEvidence();
  seen_by_many.sides[0].num_views = 7;
  AddLine(-1.f, seen_by_many);
  EXPECT_TRUE(Find().empty());
  AddPlane({0.0, 1.0, 0.0}, {0.0, -1.0, 4.0}, 1, 500.0);
  const std::vector<BoundingCrease> creases = Find();
  ASSERT_EQ(creases.size(), 1u);
  EXPECT_FALSE(creases[0].is_new);
}

// The two edges of a skirting board are one line.
TEST_F(BoundingCreasesTest, AFallAndARiseSideBySideAreNoPattern) {
  AddLine(-1.f);
  AddLine(0.2f, MeasuredOnBothSides(), 3.f);
  AddLine(0.2f + 4.f * kPixel, MeasuredOnBothSides(), -3.f);
  ExpectCreaseAt(-1.0);
  AddLine(0.8f, MeasuredOnBothSides(), 3.f);
  EXPECT_TRUE(Find().empty());
}

}  // namespace
}  // namespace tsar
