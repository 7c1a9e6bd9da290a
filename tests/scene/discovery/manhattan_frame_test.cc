// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/manhattan_frame.h"

#include <cmath>

#include "tests/scene/adjustment/adjust_planes_fixture.h"
#include "tests/support/synthetic_observations.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr double kLossScale = 0.5;
constexpr double kError = 0.01;  // The error of the samples.

bool AcceptAll(int, const WorldPlane&) { return true; }

void ExpectSame(const WorldPlane& a, const WorldPlane& b) {
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.offset, b.offset);
}

// A room that stands askew in the world.
class ManhattanFrameTest : public testing::Test {
 protected:
  // Measures a surface whose plane was found turned about the line through the
  // rectangle's middle along its length, and about its normal's cross product
  // with that.
  MeasuredPlane Measure(const Patch& surface,
                        double lean_degrees,
                        double other_degrees = 0.0) {
    constexpr int kCount = 20;
    MeasuredPlane measured;
    const Eigen::Vector3d normal =
        Eigen::AngleAxisd(Radians(lean_degrees),
                          surface.half_length.normalized()) *
        Eigen::AngleAxisd(Radians(other_degrees),
                          surface.half_width.normalized()) *
        surface.Plane().normal;
    measured.plane = PlaneThrough(normal, surface.middle);
    measured.support = 100.0;
    for (int i = 0; i < kCount * kCount; ++i) {
      const double u = 2.0 * (i % kCount) / (kCount - 1) - 1.0;
      const double v = 2.0 * (i / kCount) / (kCount - 1) - 1.0;
      DepthObservation observation;
      observation.center = camera_;
      observation.ray = surface.middle + u * surface.half_length +
                        v * surface.half_width - camera_;
      observation.depth = 1.0;
      // Along the normal.
      observation.sigma =
          kError / std::abs(surface.Plane().normal.dot(observation.ray));
      observation.depth += observation.sigma * NextNormal(&random_);
      measured.samples.Add(observation);
    }
    return measured;
  }

  Eigen::Vector3d At(double right, double up, double ahead) const {
    return room_ * Eigen::Vector3d(right, up, ahead);
  }

  const Eigen::Matrix3d room_ =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, -2.0, 0.5).normalized())
          .toRotationMatrix();
  const Eigen::Vector3d camera_ = At(0.1, 0.2, -0.3);
  const Patch floor_ = {
      At(0.0, -1.5, 3.0), At(2.0, 0.0, 0.0), At(0.0, 0.0, 2.0)};
  // Only a narrow band of the walls is measured.
  const Patch back_ = {At(0.0, 0.4, 5.0), At(2.0, 0.0, 0.0), At(0.0, 0.1, 0.0)};
  const Patch before_ = {
      At(1.0, 0.6, 4.0), At(0.8, 0.0, 0.0), At(0.0, 0.1, 0.0)};
  const Patch left_ = {
      At(-2.0, 0.3, 3.0), At(0.0, 0.0, 1.5), At(0.0, 0.1, 0.0)};
  Philox random_{3, 0, 0};
  // What leaning walls and the floor were measured as.
  const std::vector<Patch> surfaces_ = {back_, floor_, before_, left_};
  const std::vector<MeasuredPlane> planes_ = {Measure(back_, 1.0),
                                              Measure(floor_, 0.03, -0.02),
                                              Measure(before_, -0.7, 0.4),
                                              Measure(left_, 0.8, -0.1)};
};

TEST_F(ManhattanFrameTest, WallsBecomeParallelInTheirOrder) {
  const std::vector<WorldPlane> planes =
      AlignToManhattanFrame(planes_, kLossScale, AcceptAll);
  ASSERT_EQ(planes.size(), 4u);
  EXPECT_LT(planes[0].normal.cross(planes[2].normal).norm(), 1e-9);
  EXPECT_LT(std::abs(planes[0].normal.dot(planes[1].normal)), 1e-9);
  EXPECT_LT(std::abs(planes[0].normal.dot(planes[3].normal)), 1e-9);
  EXPECT_LT(std::abs(planes[1].normal.dot(planes[3].normal)), 1e-9);
  for (size_t i = 0; i < planes.size(); ++i) {
    EXPECT_NEAR(planes[i].normal.norm(), 1.0, 1e-12);
    EXPECT_LT(AngleBetween(planes[i], surfaces_[i].Plane()), 0.1) << i;
    EXPECT_NEAR(planes[i].Height(surfaces_[i].middle), 0.0, 0.003) << i;
  }
}

TEST_F(ManhattanFrameTest, TellsWhichPlanesLieAlongWhichDirection) {
  std::optional<ManhattanFrame> frame;
  const std::vector<WorldPlane> planes = AlignToManhattanFrame(
      planes_,
      kLossScale,
      [](int p, const WorldPlane&) { return p != 3; },
      &frame);
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->rotation.isUnitary(1e-12));
  EXPECT_NEAR(frame->rotation.determinant(), 1.0, 1e-12);
  ASSERT_EQ(frame->axes.size(), 4u);
  EXPECT_EQ(frame->axes[0], frame->axes[2]);
  EXPECT_EQ(frame->axes[3], -1);
  for (int p = 0; p < 3; ++p) {
    const auto i = static_cast<size_t>(p);
    EXPECT_NEAR(
        std::abs(frame->rotation.col(frame->axes[i]).dot(planes[i].normal)),
        1.0,
        1e-12);
  }
  AlignToManhattanFrame({planes_[0]}, kLossScale, AcceptAll, &frame);
  EXPECT_FALSE(frame);
}

TEST_F(ManhattanFrameTest, ObliquePlanesStayAsTheyAre) {
  // At 20 degrees to the floor, and far from orthogonal to any direction.
  const Eigen::Vector3d up_the_roof = At(0.6, -0.25, 0.8);
  const MeasuredPlane roof = Measure(
      {At(0.0, 2.0, 3.0), up_the_roof, up_the_roof.cross(At(0.25, 1.0, 0.1))},
      0.0);
  const Eigen::Vector3d in_room = room_.transpose() * roof.plane.normal;
  ASSERT_GT(in_room.cwiseAbs().minCoeff(), std::sin(Radians(5.1)));
  std::vector<MeasuredPlane> planes = planes_;
  planes.insert(planes.begin() + 1, roof);
  const std::vector<WorldPlane> regular =
      AlignToManhattanFrame(planes, kLossScale, AcceptAll);
  const std::vector<WorldPlane> without =
      AlignToManhattanFrame(planes_, kLossScale, AcceptAll);
  ASSERT_EQ(regular.size(), 5u);
  ExpectSame(regular[1], roof.plane);
  ExpectSame(regular[0], without[0]);
  ExpectSame(regular[4], without[3]);
}

TEST_F(ManhattanFrameTest, APillarsFaceBecomesVertical) {
  const Patch face = {At(0.5, 0.0, 3.0),
                      At(0.0, 0.8, 0.0),
                      At(std::sqrt(0.5), 0.0, std::sqrt(0.5)) * 0.6};
  // Leans by 1 degree, and is turned by 1 about the vertical.
  std::vector<MeasuredPlane> planes = planes_;
  planes.push_back(Measure(face, 1.0, 1.0));
  ASSERT_NEAR(AngleBetween(planes[4].plane, face.Plane()), 1.41, 0.01);
  const std::vector<WorldPlane> regular =
      AlignToManhattanFrame(planes, kLossScale, AcceptAll);
  EXPECT_LT(std::abs(regular[4].normal.dot(regular[1].normal)), 1e-9);
  EXPECT_LT(AngleBetween(regular[4], face.Plane()), 0.3);
  EXPECT_NEAR(regular[4].Height(face.middle), 0.0, 0.003);
  // It is aligned only where that is permitted.
  const std::vector<WorldPlane> refused = AlignToManhattanFrame(
      planes, kLossScale, [](int p, const WorldPlane&) { return p != 4; });
  ExpectSame(refused[4], planes[4].plane);
}

// Walls that do stand askew.
TEST_F(ManhattanFrameTest, PlanesThatAreRefusedOneAfterAnotherPullNothing) {
  constexpr int kCount = 4;
  std::vector<MeasuredPlane> planes = planes_;
  for (int i = 0; i < kCount; ++i) {
    planes.push_back(Measure({At(0.0, 0.0, 4.5 + 0.1 * i),
                              At(1.5, 0.0, 0.0),
                              At(0.0, 1.5, 1.5 * std::tan(Radians(3.0)))},
                             0.0));
    planes.back().support = 50.0;
  }
  // As if each became too bad once the one before it no longer counts.
  std::vector<int> num_asked(planes.size(), 0);
  const std::vector<WorldPlane> regular =
      AlignToManhattanFrame(planes, kLossScale, [&](int p, const WorldPlane&) {
        return p < 4 || ++num_asked[p] <= p - 4;
      });
  for (int p = 4; p < 4 + kCount; ++p) {
    ExpectSame(regular[p], planes[p].plane);
  }
  const std::vector<WorldPlane> without =
      AlignToManhattanFrame(planes_, kLossScale, AcceptAll);
  for (size_t i = 0; i < planes_.size(); ++i) {
    ExpectSame(regular[i], without[i]);
  }
}

TEST_F(ManhattanFrameTest, NothingChangesWithoutAnOrthogonalPair) {
  const Patch at_60 = {
      At(0.0, 0.0, 4.0), At(1.0, 0.0, 0.0), At(0.0, 0.5, std::sqrt(0.75))};
  const std::vector<MeasuredPlane> planes = {
      planes_[0], Measure(at_60, 0.0), planes_[2]};
  const std::vector<WorldPlane> regular =
      AlignToManhattanFrame(planes, kLossScale, AcceptAll);
  ASSERT_EQ(regular.size(), 3u);
  for (size_t i = 0; i < planes.size(); ++i) {
    ExpectSame(regular[i], planes[i].plane);
  }
}

TEST_F(ManhattanFrameTest, TakesNormalsOfEitherDirection) {
  const std::vector<WorldPlane> regular =
      AlignToManhattanFrame(planes_, kLossScale, AcceptAll);
  for (int turned = 0; turned < 4; ++turned) {
    std::vector<MeasuredPlane> planes = planes_;
    WorldPlane& plane = planes[turned].plane;
    plane = {-plane.normal, -plane.offset};
    const std::vector<WorldPlane> result =
        AlignToManhattanFrame(planes, kLossScale, AcceptAll);
    for (int i = 0; i < 4; ++i) {
      const double sign = i == turned ? -1.0 : 1.0;
      EXPECT_LT((result[i].normal - sign * regular[i].normal).norm(), 1e-6);
      EXPECT_NEAR(result[i].offset, sign * regular[i].offset, 1e-6);
    }
  }
}

TEST_F(ManhattanFrameTest, TheDirectionsOfMostSupportWin) {
  // Another room, turned by 30 degrees about an oblique axis.
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(Radians(30.0), At(1.0, 1.0, 1.0).normalized())
          .toRotationMatrix();
  const auto turned = [&](const Patch& surface) {
    return Patch{
        surface.middle, turn * surface.half_length, turn * surface.half_width};
  };
  std::vector<MeasuredPlane> planes = planes_;
  planes.push_back(Measure(turned(back_), 1.0));
  planes.push_back(Measure(turned(floor_), 0.02));
  for (const bool other_room : {false, true}) {
    planes[4].support = planes[5].support = other_room ? 201.0 : 199.0;
    const std::vector<WorldPlane> regular =
        AlignToManhattanFrame(planes, kLossScale, AcceptAll);
    for (int i = 0; i < 6; ++i) {
      if ((i >= 4) != other_room) {
        ExpectSame(regular[i], planes[i].plane);
      }
    }
    const int first = other_room ? 4 : 0;
    EXPECT_LT(std::abs(regular[first].normal.dot(regular[first + 1].normal)),
              1e-9);
  }
}

TEST_F(ManhattanFrameTest, PlanesWithoutSamplesStayInTheirPlace) {
  std::vector<MeasuredPlane> planes = planes_;
  planes[3].samples = {};
  const std::vector<WorldPlane> regular =
      AlignToManhattanFrame(planes, kLossScale, AcceptAll);
  EXPECT_LT(std::abs(regular[3].normal.dot(regular[0].normal)), 1e-9);
  EXPECT_LT(std::abs(regular[3].normal.dot(regular[1].normal)), 1e-9);
  const Eigen::Vector3d foot = -planes[3].plane.offset * planes[3].plane.normal;
  EXPECT_NEAR(regular[3].Height(foot), 0.0, 1e-3);
}

}  // namespace
}  // namespace tsar
