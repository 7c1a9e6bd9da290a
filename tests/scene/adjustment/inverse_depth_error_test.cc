// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/adjustment/inverse_depth_error.h"

#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

class InverseDepthErrorTest : public testing::Test {
 protected:
  InverseDepthErrorTest() {
    camera_.rotation =
        Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized())
            .toRotationMatrix();
    camera_.translation = {0.5, -0.2, 0.4};
    // 3 in front of the camera, a little tilted.
    const Eigen::Vector3d in_view =
        Eigen::Vector3d(0.1, -0.2, -1.0).normalized();
    plane_.plane.normal = camera_.rotation.transpose() * in_view;
    plane_.center = camera_.rotation.transpose() *
                    (Eigen::Vector3d(0.7, 0.4, 3.0) - camera_.translation);
    plane_.plane.offset = -plane_.plane.normal.dot(plane_.center);
    plane_.axis_s = plane_.plane.normal.unitOrthogonal();
    plane_.axis_t = plane_.plane.normal.cross(plane_.axis_s);
  }

  double InverseDepth(const WorldPlane& plane, const Vec3f& ray) const {
    const Eigen::Vector3d direction =
        camera_.rotation.transpose() * Eigen::Vector3d(ray.x, ray.y, ray.z);
    return -plane.normal.dot(direction) / plane.Height(camera_.Center());
  }
  // The plane after small turns about its axes and a shift along its normal.
  WorldPlane Moved(const Eigen::Vector3d& by) const {
    const Eigen::Vector3d turn = by(0) * plane_.axis_s + by(1) * plane_.axis_t;
    WorldPlane moved;
    moved.normal = plane_.plane.normal;
    if (turn.norm() > 0.0) {
      moved.normal =
          Eigen::AngleAxisd(turn.norm(), turn.normalized()) * moved.normal;
    }
    moved.offset = -moved.normal.dot(plane_.center) - by(2);
    return moved;
  }
  // By numerical derivatives.
  double ExpectedVariance(const Eigen::Matrix3d& covariance,
                          const Vec3f& ray) const {
    constexpr double kStep = 1e-5;
    Eigen::Vector3d slope;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
      slope(i) =
          (InverseDepth(Moved(step), ray) - InverseDepth(Moved(-step), ray)) /
          (2.0 * kStep);
    }
    return slope.dot(covariance * slope);
  }

  Camera camera_;
  ModelPlane plane_;
};

TEST_F(InverseDepthErrorTest, IsThatOfThePlaneToFirstOrder) {
  plane_.covariance << 4e-8, 1e-8, -2e-8,  //
      1e-8, 9e-8, 3e-8,                    //
      -2e-8, 3e-8, 1e-7;
  for (const double sign : {1.0, -1.0}) {
    const InverseDepthError error = ErrorInView(plane_, camera_);
    for (const Vec3f& ray :
         {Vec3f{0.f, 0.f, 1.f}, {0.4f, -0.3f, 1.f}, {-0.6f, 0.2f, 1.f}}) {
      const double expected = ExpectedVariance(plane_.covariance, ray);
      EXPECT_GT(expected, 1e-10);
      EXPECT_NEAR(error.Variance(ray), expected, 1e-3 * expected) << sign;
    }
    plane_.plane.normal = -plane_.plane.normal;
    plane_.plane.offset = -plane_.plane.offset;
  }
}

TEST_F(InverseDepthErrorTest, WhatIsNotKnownIsBounded) {
  plane_.covariance = Eigen::Vector3d(kUnknown, 1e-8, kUnknown).asDiagonal();
  const double shift = 0.01 * plane_.plane.Height(camera_.Center());
  const Eigen::Matrix3d bounded =
      Eigen::Vector3d(0.02 * 0.02, 1e-8, shift * shift).asDiagonal();
  const Vec3f ray{0.3f, -0.4f, 1.f};
  const double expected = ExpectedVariance(bounded, ray);
  EXPECT_NEAR(
      ErrorInView(plane_, camera_).Variance(ray), expected, 1e-3 * expected);
}

TEST_F(InverseDepthErrorTest, APlaneThroughTheCameraHasNone) {
  plane_.plane.offset = 0.0;
  camera_.translation.setZero();
  plane_.covariance.setIdentity();
  EXPECT_EQ(ErrorInView(plane_, camera_).Variance({0.f, 0.f, 1.f}), 0.f);
}

}  // namespace
}  // namespace tsar
