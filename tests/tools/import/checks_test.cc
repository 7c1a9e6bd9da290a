// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_checks.h"

#include "tests/support/test_workspace.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tsar {
namespace {

// Cameras along a line of the given length, each turned by `turn` degrees more.
SparseModel MakeModel(int num_images, double length, double turn) {
  SparseModel model;
  for (int i = 0; i < num_images; ++i) {
    SparseModel::ModelImage& image = model.images.emplace_back();
    image.name = "v" + std::to_string(i) + ".jpg";
    image.camera = {400, 300, 350.0, 350.0, 200.0, 150.0};
    image.camera.rotation =
        Eigen::AngleAxisd(turn * i * M_PI / 180.0, Eigen::Vector3d::UnitY())
            .toRotationMatrix();
    image.camera.translation =
        -image.camera.rotation *
        Eigen::Vector3d(length * i / std::max(1, num_images - 1), 0, 0);
  }
  model.IndexNames();
  return model;
}

// The cameras for images of half the size.
std::vector<AssignedCamera> CamerasOf(const SparseModel& model,
                                      double scale = 1.0) {
  std::vector<AssignedCamera> cameras;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const Camera& camera = model.images[i].camera;
    AssignedCamera& assigned = cameras.emplace_back();
    assigned.image = static_cast<int>(i);
    assigned.camera.file = "cam" + std::to_string(i);
    assigned.camera.rotation = camera.rotation;
    assigned.camera.center = scale * camera.Center();
    assigned.camera.fx = camera.fx / 2.0;
    assigned.camera.fy = camera.fy / 2.0;
    assigned.camera.cx = camera.cx / 2.0;
    assigned.camera.cy = camera.cy / 2.0;
  }
  return cameras;
}

void ExpectRefused(const std::vector<AssignedCamera>& cameras,
                   const SparseModel& model,
                   const std::vector<std::string>& texts) {
  ExpectError(
      ErrorCode::kMismatch, texts, [&] { CheckCameras(cameras, model, 1.0); });
}

TEST(CheckCameras, AcceptsTheSameUpToRounding) {
  const SparseModel model = MakeModel(5, 2.0, 10.0);
  std::vector<AssignedCamera> cameras = CamerasOf(model);
  for (AssignedCamera& assigned : cameras) {
    assigned.camera.center += Eigen::Vector3d(0.0, 0.01, 0.0);
    assigned.camera.rotation =
        Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitX()).toRotationMatrix() *
        assigned.camera.rotation;
    // OpenMVS moves the principal point by half a pixel.
    assigned.camera.cx -= 0.5;
  }
  CheckCameras(cameras, model, 1.0);
  CheckCameras({}, model, 1.0);
  const SparseModel single = MakeModel(1, 0.0, 0.0);
  CheckCameras(CamerasOf(single), single, 1.0);
  // In other units.
  CheckCameras(CamerasOf(model, 40.0), model, 0.025);
  ExpectRefused(CamerasOf(model, 40.0), model, {"cam1", "give depth_scale"});
  cameras[1].camera.center.z() += 0.05;
  ExpectRefused(cameras, model, {"cam1", "v1.jpg", "extent"});
}

TEST(CheckCameras, NamesTheImageWhoseCameraItIs) {
  const SparseModel model = MakeModel(5, 2.0, 10.0);
  std::vector<AssignedCamera> cameras = CamerasOf(model);
  std::swap(cameras[1].image, cameras[4].image);
  ExpectRefused(cameras,
                model,
                {"cam1", "camera of v1.jpg, not of v4.jpg", "another order"});
}

// As in a film, where neighbors differ by less than the tolerance.
TEST(CheckCameras, TellsNeighborsApart) {
  const SparseModel model = MakeModel(300, 10.0, 0.3);
  std::vector<AssignedCamera> cameras = CamerasOf(model);
  CheckCameras(cameras, model, 1.0);
  for (size_t i = 0; i + 1 < cameras.size(); ++i) {
    cameras[i].image = static_cast<int>(i) + 1;
  }
  cameras.pop_back();
  ExpectRefused(cameras, model, {"cam0", "camera of v0.jpg, not of v1.jpg"});
}

TEST(CheckCameras, TellsOtherIntrinsics) {
  const SparseModel model = MakeModel(2, 2.0, 10.0);
  std::vector<AssignedCamera> cameras = CamerasOf(model);
  for (double* changed : {&cameras[1].camera.fx, &cameras[1].camera.fy}) {
    *changed *= 1.05;
    ExpectRefused(cameras, model, {"cam1", "v1.jpg", "focal length"});
  }
}

// One camera at the origin; points at depths 1, 2, ..., num_points.
SparseModel MakeModel(int num_points) {
  SparseModel model;
  SparseModel::ModelImage& image = model.images.emplace_back();
  image.name = "a.png";
  image.camera = {100, 80, 50.0, 50.0, 50.0, 40.0};
  for (int i = 0; i < num_points; ++i) {
    const double z = i + 1.0;
    model.points.emplace_back(0.08 * (i - 5) * z, 0.0, z);
    image.point_indices.push_back(i);
  }
  model.IndexNames();
  return model;
}

TEST(CompareWithSparse, TakesTheMedianRatio) {
  const SparseModel model = MakeModel(11);
  // Point i is seen in column 50 + 4 (i - 5); depth of half the size.
  Image<float> depth(50, 40);
  for (int i = 0; i < 11; ++i) {
    const float wrong = i == 3 ? 100.f : 1.f;
    const int x = 25 + 2 * (i - 5);
    depth(x, 20) = 3.f * static_cast<float>(i + 1) * wrong;
  }
  depth(0, 0) = 7.f;
  const SparseComparison comparison = CompareWithSparse(model, 0, depth);
  EXPECT_EQ(comparison.num_points, 11);
  EXPECT_NEAR(comparison.ratio, 3.0, 1e-6);
}

TEST(CompareWithSparse, LeavesOutPointsOutsideOrBehindOrWithoutDepth) {
  SparseModel model = MakeModel(4);
  model.points[0] = {0.0, 0.0, -1.0};
  model.points[1] = {100.0, 0.0, 1.0};
  model.points[2] = {0.0, -100.0, 1.0};
  EXPECT_EQ(CompareWithSparse(model, 0, Image<float>(100, 80, 1.f)).num_points,
            1);
  EXPECT_EQ(CompareWithSparse(model, 0, Image<float>(100, 80)).num_points, 0);
}

TEST(JudgeScale, IsConsistentWhereFourOfFiveAgree) {
  const ScaleVerdict verdict = JudgeScale(
      {{10, 2.0}, {10, 2.1}, {10, 1.9}, {10, 2.0}, {10, 9.0}, {4, 0.1}});
  EXPECT_EQ(verdict.num_images, 5);
  EXPECT_EQ(verdict.median, 2.0);
  EXPECT_EQ(verdict.smallest, 1.9);
  EXPECT_EQ(verdict.largest, 9.0);
  EXPECT_TRUE(verdict.is_consistent);
  EXPECT_FALSE(JudgeScale({{10, 1.0}, {10, 2.0}, {10, 3.0}}).is_consistent);
  EXPECT_EQ(JudgeScale({}).num_images, 0);
  EXPECT_FALSE(JudgeScale({{2, 3.0}}).is_consistent);
}

TEST(IsOffScale, BeginsAtTwentyPercent) {
  for (const double ratio : {1.0, 1.19, 0.84}) {
    EXPECT_FALSE(IsOffScale(ratio)) << ratio;
  }
  for (const double ratio : {1.21, 0.82, 0.0, 1000.0}) {
    EXPECT_TRUE(IsOffScale(ratio)) << ratio;
  }
}

}  // namespace
}  // namespace tsar
