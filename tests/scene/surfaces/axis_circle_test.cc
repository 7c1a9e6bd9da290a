// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/axis_camera.h"

#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr double kFocal = 200.0;
const AxisCircle kCircle = {{0.2, 3.0}, 0.3};

// In the plane, at an angle around (0, 3) and looking at it.
AxisCamera MakeCamera(double angle) {
  AxisCamera camera;
  camera.width = 240;
  camera.height = 180;
  camera.focal = kFocal;
  camera.cx = 120.0;
  camera.cy = 90.0;
  camera.center = {3.0 * std::sin(angle), 3.0 - 3.0 * std::cos(angle)};
  camera.forward = {-std::sin(angle), std::cos(angle)};
  camera.right = {std::cos(angle), std::sin(angle)};
  return camera;
}

std::vector<CircleTangent> TangentsOf(const std::vector<AxisCamera>& cameras,
                                      const AxisCircle& circle) {
  std::vector<CircleTangent> tangents;
  for (const AxisCamera& camera : cameras) {
    const std::optional<CircleOutline> outline = OutlineOf(circle, camera);
    tangents.push_back({&camera, outline.value().left, true});
    tangents.push_back({&camera, outline.value().right, false});
  }
  return tangents;
}

TEST(AxisCircleTest, OutlinesTouchTheCircle) {
  const AxisCamera camera = MakeCamera(0.3);
  const std::optional<CircleOutline> outline = OutlineOf(kCircle, camera);
  ASSERT_TRUE(outline);
  EXPECT_LT(outline->left, outline->right);
  for (const bool is_left : {true, false}) {
    const double column = is_left ? outline->left : outline->right;
    const double distance =
        is_left ? outline->left_distance : outline->right_distance;
    const Eigen::Vector2d direction = camera.Direction(column);
    const Eigen::Vector2d point = camera.center + distance * direction;
    EXPECT_NEAR((point - kCircle.center).norm(), kCircle.radius, 1e-9);
    EXPECT_NEAR((point - kCircle.center).dot(direction), 0.0, 1e-9);
  }
}

TEST(AxisCircleTest, HasNoOutlinesFromWithinNorBehind) {
  const AxisCamera camera = MakeCamera(0.0);
  EXPECT_FALSE(OutlineOf({camera.center, 0.3}, camera));
  EXPECT_FALSE(OutlineOf({camera.center, 0.0}, camera));
  EXPECT_FALSE(OutlineOf({{0.0, 0.35}, 0.3}, camera));
  EXPECT_FALSE(OutlineOf({{0.0, -3.0}, 0.3}, camera));
  EXPECT_FALSE(OutlineOf({{NAN, 3.0}, 0.3}, camera));
  EXPECT_FALSE(OutlineOf({{0.0, 3.0}, NAN}, camera));
  EXPECT_TRUE(OutlineOf({{0.0, 3.0}, 0.0}, camera));
}

TEST(AxisCircleTest, FitsTheCircle) {
  const std::vector<AxisCamera> cameras = {
      MakeCamera(-0.4), MakeCamera(0.0), MakeCamera(0.3)};
  const std::vector<CircleTangent> tangents = TangentsOf(cameras, kCircle);
  for (const AxisCircle* near :
       {static_cast<const AxisCircle*>(nullptr), &kCircle}) {
    Eigen::Matrix3d covariance;
    const std::optional<AxisCircle> fitted =
        FitCircle(tangents, near, &covariance);
    ASSERT_TRUE(fitted);
    EXPECT_NEAR((fitted->center - kCircle.center).norm(), 0.0, 1e-9);
    EXPECT_NEAR(fitted->radius, kCircle.radius, 1e-9);
    EXPECT_GT(covariance(2, 2), 0.0);
  }
}

TEST(AxisCircleTest, TwoViewsThatMayShowOneCircleDo) {
  const AxisCamera a = MakeCamera(-0.3);
  const AxisCamera b = MakeCamera(0.3);
  const CircleOutline of_a = *OutlineOf(kCircle, a);
  const CircleOutline of_b = *OutlineOf(kCircle, b);
  EXPECT_TRUE(
      MayShowOneCircle({a, of_a.left, of_a.right}, {b, of_b.left, of_b.right}));
  // Twice as wide.
  EXPECT_FALSE(MayShowOneCircle({a, of_a.left, of_a.right},
                                {b,
                                 1.5 * of_b.left - 0.5 * of_b.right,
                                 1.5 * of_b.right - 0.5 * of_b.left}));
  // Rays that meet behind the cameras, or nowhere.
  EXPECT_FALSE(MayShowOneCircle({a, 0.0, 20.0}, {b, 220.0, 240.0}));
  EXPECT_FALSE(MayShowOneCircle({a, 100.0, 140.0}, {a, 100.0, 140.0}));
}

TEST(AxisCircleTest, FitsNothingToNothing) {
  EXPECT_FALSE(FitCircle({}, nullptr, nullptr));
  EXPECT_FALSE(FitCircle({}, &kCircle, nullptr));
  EXPECT_FALSE(FitPoint({}));
}

TEST(AxisCircleTest, FitsNothingToTangentsThatDoNotDetermineIt) {
  const std::vector<AxisCamera> cameras = {MakeCamera(-0.3), MakeCamera(0.3)};
  const std::vector<CircleTangent> tangents = TangentsOf(cameras, kCircle);
  const CircleTangent& first = tangents[0];
  EXPECT_FALSE(FitCircle({first}, nullptr, nullptr));
  EXPECT_FALSE(FitCircle({tangents[0], tangents[1]}, nullptr, nullptr));
  EXPECT_FALSE(FitCircle({first, first, first, first}, nullptr, nullptr));
  EXPECT_FALSE(FitPoint({first}));
  EXPECT_FALSE(FitPoint({first, first, first}));
  EXPECT_TRUE(FitCircle(tangents, nullptr, nullptr));
  EXPECT_TRUE(FitPoint(tangents));
}

// Of outlines that are exchanged the circle would have a negative radius.
TEST(AxisCircleTest, FitsNothingToWhatNoCircleShows) {
  const std::vector<AxisCamera> cameras = {MakeCamera(-0.3), MakeCamera(0.3)};
  std::vector<CircleTangent> tangents = TangentsOf(cameras, kCircle);
  for (CircleTangent& tangent : tangents) {
    tangent.is_left = !tangent.is_left;
  }
  EXPECT_FALSE(FitCircle(tangents, nullptr, nullptr));
  tangents = TangentsOf(cameras, kCircle);
  tangents[1].column = NAN;
  EXPECT_FALSE(FitCircle(tangents, nullptr, nullptr));
  tangents[1].column = INFINITY;
  EXPECT_FALSE(FitCircle(tangents, nullptr, nullptr));
}

}  // namespace
}  // namespace tsar
