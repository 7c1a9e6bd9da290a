// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/camera.h"

#include "colmap_tsar/base/disparity.h"

#include "tests/support/synthetic_scene.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tsar {
namespace {

Eigen::Matrix3d Rotation(double x, double y, double z) {
  return (Eigen::AngleAxisd(x, Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(y, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(z, Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

Camera PlaceAt(const Eigen::Vector3d& center, const Eigen::Matrix3d& rotation) {
  Camera camera = SyntheticCamera(640, 480, 500.0);
  camera.rotation = rotation;
  camera.translation = -rotation * center;
  return camera;
}

TEST(Intrinsics, ProjectUndoesRay) {
  const Intrinsics intrinsics{500.f, 510.f, 320.5f, 239.f};
  const Vec3f axis = intrinsics.Ray(320.5f, 239.f);
  EXPECT_EQ(axis, (Vec3f{0.f, 0.f, 1.f}));
  float x = 0.f;
  float y = 0.f;
  intrinsics.Project(intrinsics.Ray(17.f, 400.f) * 3.f, &x, &y);
  EXPECT_NEAR(x, 17.f, 1e-3f);
  EXPECT_NEAR(y, 400.f, 1e-3f);
}

TEST(Camera, ResizedScalesEveryIntrinsicByItsOwnAxis) {
  Camera camera = SyntheticCamera(640, 480, 500.0);
  camera.fy = 400.0;
  camera.rotation = Rotation(0.1, 0.2, 0.3);
  camera.translation = {1.0, 2.0, 3.0};
  const Camera resized = camera.Resized(320, 120);
  EXPECT_EQ(resized.width, 320);
  EXPECT_EQ(resized.height, 120);
  EXPECT_DOUBLE_EQ(resized.fx, 250.0);
  EXPECT_DOUBLE_EQ(resized.fy, 100.0);
  EXPECT_DOUBLE_EQ(resized.cx, 160.0);
  EXPECT_DOUBLE_EQ(resized.cy, 60.0);
  EXPECT_EQ(resized.rotation, camera.rotation);
  EXPECT_EQ(resized.translation, camera.translation);
}

TEST(RelativePose, TakesPointsFromTheReferenceToTheSource) {
  const Camera reference = PlaceAt({1.0, 2.0, 3.0}, Rotation(0.1, 0.2, 0.3));
  const Camera source = PlaceAt({1.5, 1.8, 2.9}, Rotation(-0.1, 0.4, 0.2));
  const Eigen::Vector3d world(2.0, 1.0, 8.0);
  const Eigen::Vector3d in_reference =
      reference.rotation * world + reference.translation;
  const Eigen::Vector3d in_source =
      source.rotation * world + source.translation;
  const Vec3f mapped = ComputeRelativePose(reference, source) *
                       Vec3f{static_cast<float>(in_reference.x()),
                             static_cast<float>(in_reference.y()),
                             static_cast<float>(in_reference.z())};
  EXPECT_NEAR(mapped.x, in_source.x(), 1e-5);
  EXPECT_NEAR(mapped.y, in_source.y(), 1e-5);
  EXPECT_NEAR(mapped.z, in_source.z(), 1e-5);
}

// Georeferenced models have coordinates in meters from the equator.
TEST(RelativePose, KeepsItsDigitsFarFromTheOrigin) {
  const Eigen::Vector3d origin(691234.25, 5335678.5, 512.75);
  const Eigen::Matrix3d reference_rotation = Rotation(0.4, 0.1, -0.9);
  const Eigen::Matrix3d source_rotation = Rotation(0.5, -0.1, -0.8);
  const Eigen::Vector3d step(0.125, -0.0625, 0.03125);
  const RelativePose near =
      ComputeRelativePose(PlaceAt(Eigen::Vector3d::Zero(), reference_rotation),
                          PlaceAt(step, source_rotation));
  const RelativePose far =
      ComputeRelativePose(PlaceAt(origin, reference_rotation),
                          PlaceAt(origin + step, source_rotation));
  // Doubles hold these coordinates to a nanometer.
  EXPECT_NEAR(Norm(far.translation - near.translation), 0.f, 1e-7f);
  EXPECT_NEAR(Norm(far.rotation.row0 - near.rotation.row0), 0.f, 1e-6f);
  EXPECT_NEAR(Norm(near.translation), step.norm(), 1e-6);
}

Camera PlaceAt(double x) {
  Camera camera = SyntheticCamera(kPaperSize, 2000, 3000.0);
  camera.translation = {-x, 0.0, 0.0};
  return camera;
}

TEST(DisparityScale, AveragesTheFourShortestBaselines) {
  const DisparityScale scale = ComputeDisparityScale(PlaceAt(0.0),
                                                     {PlaceAt(100.0),
                                                      PlaceAt(4.0),
                                                      PlaceAt(-1.0),
                                                      PlaceAt(0.0),
                                                      PlaceAt(2.0),
                                                      PlaceAt(-3.0)});
  EXPECT_FLOAT_EQ(scale.ToDisparity(1.f), 3000.f * 2.5f);
}

TEST(DisparityScale, DoesNotDependOnTheMapsSize) {
  const Camera reference = PlaceAt(0.0);
  const float full =
      ComputeDisparityScale(reference, {PlaceAt(0.5)}).ToDisparity(3.f);
  for (const int divisor : {2, 4, 10}) {
    const Camera reduced = reference.Resized(reference.width / divisor,
                                             reference.height / divisor);
    EXPECT_NEAR(ComputeDisparityScale(reduced, {PlaceAt(0.5)}).ToDisparity(3.f),
                full,
                1e-3f * full);
  }
}

TEST(DisparityScale, IsZeroWithoutABaseline) {
  EXPECT_EQ(ComputeDisparityScale(PlaceAt(0.0), {}).factor, 0.f);
  EXPECT_EQ(ComputeDisparityScale(PlaceAt(0.0), {PlaceAt(0.0)}).factor, 0.f);
}

TEST(DisparityScale, DepthErrorIsOnePixelOfTheMapWithinItsBounds) {
  // f b = 1500, so one pixel is 1 / 150 of the depth 10.
  const Camera reference = PlaceAt(0.0);
  const DisparityScale scale = ComputeDisparityScale(reference, {PlaceAt(0.5)});
  EXPECT_FLOAT_EQ(scale.RelativeDepthError(10.f), 10.f / 1500.f);
  EXPECT_FLOAT_EQ(scale.RelativeDepthError(0.1f), 0.002f);
  EXPECT_FLOAT_EQ(scale.RelativeDepthError(1e4f), 0.02f);
  // In a map of half the size, a pixel is twice as much.
  const DisparityScale half = ComputeDisparityScale(
      reference.Resized(reference.width / 2, reference.height / 2),
      {PlaceAt(0.5)});
  EXPECT_NEAR(half.RelativeDepthError(10.f), 20.f / 1500.f, 1e-6f);
}

}  // namespace
}  // namespace tsar
