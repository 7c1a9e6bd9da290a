// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/planes/fit_plane.h"

#include <cmath>

#include "tests/support/synthetic_observations.h"
#include "tests/view/planes/fit_plane_checks.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// Three planes at right angles, like those of a room's corner, and what three
// cameras measured of each.
class FitTogetherTest : public testing::Test {
 protected:
  static constexpr int kNumPlanes = 3;

  FitTogetherTest() {
    const Eigen::Matrix3d frame =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::Ones(),
                                           -Eigen::Vector3d::UnitZ())
            .toRotationMatrix();
    Philox random(8, 0, 0);
    for (int i = 0; i < kNumPlanes; ++i) {
      truth_.push_back(PlaneThrough(frame.col(i), middles_[i]));
      observations_.push_back(AddNoise(ObservePlane(truth_[i], 12), &random));
      samples_.push_back(ToSamples(observations_[i]));
    }
  }

  // The planes turned about the middles of their samples, and moved.
  std::vector<JointPlane> Turned(const Eigen::Matrix3d& rotation) const {
    std::vector<JointPlane> joint;
    for (int i = 0; i < kNumPlanes; ++i) {
      const Eigen::Vector3d normal = rotation * truth_[i].normal;
      joint.push_back(
          {PlaneThrough(normal, middles_[i] + 0.02 * (i - 1) * normal),
           &samples_[i]});
    }
    return joint;
  }

  void ExpectTruth(const std::vector<JointPlane>& found) const {
    for (int i = 0; i < kNumPlanes; ++i) {
      // Each of 432 depths errs by 0.03 or more.
      EXPECT_LT(AngleBetween(found[i].plane, truth_[i]), 0.1) << i;
      EXPECT_NEAR(found[i].plane.Height(middles_[i]), 0.0, 0.006) << i;
    }
  }

  static void ExpectTurned(const std::vector<JointPlane>& before,
                           const Eigen::Matrix3d& rotation,
                           const std::vector<JointPlane>& after) {
    EXPECT_LT(
        (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(),
        1e-12);
    for (size_t i = 0; i < before.size(); ++i) {
      EXPECT_LT(
          (rotation * before[i].plane.normal - after[i].plane.normal).norm(),
          1e-12);
    }
  }

  const Eigen::Matrix3d oblique_turn_ =
      Eigen::AngleAxisd(2.0 * M_PI / 180.0,
                        Eigen::Vector3d(3.0, -2.0, 1.0).normalized())
          .toRotationMatrix();
  const Eigen::Vector3d middles_[kNumPlanes] = {
      {0.0, 0.0, 4.0}, {0.2, 0.1, 4.2}, {-0.1, 0.2, 3.9}};
  std::vector<WorldPlane> truth_;
  std::vector<std::vector<DepthObservation>> observations_;
  std::vector<FitSamples> samples_;
};

TEST_F(FitTogetherTest, TurnsPlanesAtRightAnglesByOneRotation) {
  const std::vector<JointPlane> before = Turned(oblique_turn_);
  std::vector<JointPlane> joint = before;
  const Eigen::Matrix3d rotation =
      FitTogether(std::nullopt, kLossScale, &joint);
  ExpectTurned(before, rotation, joint);
  ExpectTruth(joint);
  EXPECT_NEAR(joint[0].plane.normal.dot(joint[1].plane.normal), 0.0, 1e-12);
  EXPECT_NEAR(joint[0].plane.normal.dot(joint[2].plane.normal), 0.0, 1e-12);
  EXPECT_NEAR(joint[1].plane.normal.dot(joint[2].plane.normal), 0.0, 1e-12);
}

TEST_F(FitTogetherTest, TurnsAboutTheAxisAlone) {
  const Eigen::Vector3d axis = truth_[0].normal;
  const std::vector<JointPlane> before =
      Turned(Eigen::AngleAxisd(2.0 * M_PI / 180.0, axis).toRotationMatrix());
  std::vector<JointPlane> joint = before;
  ExpectTurned(before, FitTogether(axis, kLossScale, &joint), joint);
  ExpectTruth(joint);
  // Where another turn would be needed.
  const std::vector<JointPlane> oblique = Turned(oblique_turn_);
  joint = oblique;
  const Eigen::Matrix3d rotation = FitTogether(axis, kLossScale, &joint);
  ExpectTurned(oblique, rotation, joint);
  EXPECT_LT((rotation * axis - axis).norm(), 1e-12);
  EXPECT_NEAR(Eigen::AngleAxisd(rotation).angle() * 180.0 / M_PI,
              std::abs(Eigen::AngleAxisd(oblique_turn_).axis().dot(axis)) * 2.0,
              0.2);
}

TEST_F(FitTogetherTest, PlanesWithoutSamplesTurnWithTheOthers) {
  const FitSamples none;
  std::vector<JointPlane> before = Turned(oblique_turn_);
  before[1].samples = &none;
  std::vector<JointPlane> joint = before;
  const Eigen::Matrix3d rotation =
      FitTogether(std::nullopt, kLossScale, &joint);
  ExpectTurned(before, rotation, joint);
  EXPECT_LT(AngleBetween(joint[0].plane, truth_[0]), 0.1);
  EXPECT_LT(AngleBetween(joint[1].plane, truth_[1]), 0.15);
  const Eigen::Vector3d foot = -before[1].plane.offset * before[1].plane.normal;
  EXPECT_NEAR(joint[1].plane.Height(foot), 0.0, 1e-3);
}

TEST_F(FitTogetherTest, NothingTurnsAboutALine) {
  // A line of samples along the plane, too narrow for their errors.
  const Eigen::Vector3d direction = truth_[0].normal.unitOrthogonal();
  const Eigen::Vector3d across = truth_[0].normal.cross(direction);
  std::vector<DepthObservation> line;
  for (int i = 0; i < 40; ++i) {
    DepthObservation observation;
    observation.ray = middles_[0] + (0.05 * i - 1.0) * direction +
                      (i % 2 == 0 ? 0.002 : -0.002) * across;
    observation.depth = 1.0;
    observation.sigma = 0.01;
    line.push_back(observation);
  }
  Philox random(5, 0, 0);
  const FitSamples samples = ToSamples(AddNoise(line, &random));
  for (const bool with_axis : {false, true}) {
    std::optional<Eigen::Vector3d> axis;
    if (with_axis) {
      axis = direction;
    }
    std::vector<JointPlane> joint = {{truth_[0], &samples}};
    const Eigen::Matrix3d rotation = FitTogether(axis, kLossScale, &joint);
    EXPECT_LT((rotation * direction).cross(direction).norm(), 0.02);
    // Across the line.
    EXPECT_NEAR((rotation * across).dot(truth_[0].normal), 0.0, 1e-3);
  }
}

}  // namespace
}  // namespace tsar
