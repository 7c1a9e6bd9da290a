// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/check_cameras.h"

#include "tests/support/test_workspace.h"
#include <Eigen/Geometry>

namespace tsar {
namespace {

// Cameras along a line of the given length, each turned by `turn` degrees more.
SparseModel MakeModel(int num_images, double length, double turn) {
  SparseModel model;
  for (int i = 0; i < num_images; ++i) {
    SparseModel::ModelImage image;
    image.name = "v";
    image.name += std::to_string(i) + ".jpg";
    image.camera.width = 400;
    image.camera.height = 300;
    image.camera.fx = 350.0;
    image.camera.fy = 350.0;
    image.camera.cx = 200.0;
    image.camera.cy = 150.0;
    image.camera.rotation =
        Eigen::AngleAxisd(turn * i * M_PI / 180.0, Eigen::Vector3d::UnitY())
            .toRotationMatrix();
    image.camera.translation =
        -image.camera.rotation *
        Eigen::Vector3d(length * i / std::max(1, num_images - 1), 0, 0);
    model.images.push_back(image);
  }
  model.IndexNames();
  return model;
}

std::vector<AssignedCamera> CamerasOf(const SparseModel& model,
                                      double scale = 1.0) {
  std::vector<AssignedCamera> cameras;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const Camera& camera = model.images[i].camera;
    AssignedCamera assigned;
    assigned.image = static_cast<int>(i);
    assigned.camera.file = "cam";
    assigned.camera.file += std::to_string(i);
    assigned.camera.rotation = camera.rotation;
    assigned.camera.center = scale * camera.Center();
    // Of a smaller image.
    assigned.camera.fx = camera.fx / 2.0;
    assigned.camera.fy = camera.fy / 2.0;
    assigned.camera.cx = camera.cx / 2.0;
    assigned.camera.cy = camera.cy / 2.0;
    cameras.push_back(assigned);
  }
  return cameras;
}

TEST(CheckCameras, AcceptsTheSameUpToRounding) {
  const SparseModel model = MakeModel(5, 2.0, 10.0);
  std::vector<AssignedCamera> cameras = CamerasOf(model);
  CheckCameras(cameras, model, 1.0);
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
  cameras[1].camera.center.z() += 0.05;
  ExpectError(ErrorCode::kMismatch, {"cam1", "v1.jpg", "extent"}, [&] {
    CheckCameras(cameras, model, 1.0);
  });
}

TEST(CheckCameras, NamesTheImageWhoseCameraItIs) {
  const SparseModel model = MakeModel(5, 2.0, 10.0);
  std::vector<AssignedCamera> cameras = CamerasOf(model);
  std::swap(cameras[1].image, cameras[4].image);
  ExpectError(ErrorCode::kMismatch,
              {"cam1", "camera of v1.jpg, not of v4.jpg", "another order"},
              [&] { CheckCameras(cameras, model, 1.0); });
}

// Of a film, where neighbours differ by less than what is allowed.
TEST(CheckCameras, TellsNeighboursApart) {
  const SparseModel model = MakeModel(300, 10.0, 0.3);
  std::vector<AssignedCamera> cameras = CamerasOf(model);
  CheckCameras(cameras, model, 1.0);
  for (size_t i = 0; i + 1 < cameras.size(); ++i) {
    cameras[i].image = static_cast<int>(i) + 1;
  }
  cameras.pop_back();
  ExpectError(ErrorCode::kMismatch,
              {"cam0", "camera of v0.jpg, not of v1.jpg"},
              [&] { CheckCameras(cameras, model, 1.0); });
}

TEST(CheckCameras, TellsOtherUnits) {
  const SparseModel model = MakeModel(5, 2.0, 10.0);
  const std::vector<AssignedCamera> cameras = CamerasOf(model, 40.0);
  ExpectError(ErrorCode::kMismatch,
              {"cam0", "other units", "depth_scale 0.025"},
              [&] { CheckCameras(cameras, model, 1.0); });
  CheckCameras(cameras, model, 0.025);
}

TEST(CheckCameras, TellsAnotherModel) {
  const SparseModel model = MakeModel(5, 2.0, 10.0);
  std::vector<AssignedCamera> cameras = CamerasOf(model);
  cameras[2].camera.rotation =
      Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  ExpectError(ErrorCode::kMismatch,
              {"cam2", "v2.jpg", "degrees", "this sparse model"},
              [&] { CheckCameras(cameras, model, 1.0); });
}

TEST(CheckCameras, TellsOtherIntrinsics) {
  const SparseModel model = MakeModel(2, 2.0, 10.0);
  std::vector<AssignedCamera> cameras = CamerasOf(model);
  cameras[1].camera.fx *= 1.05;
  ExpectError(ErrorCode::kMismatch, {"cam1", "v1.jpg", "focal length"}, [&] {
    CheckCameras(cameras, model, 1.0);
  });
  cameras[1].camera.fy *= 1.05;
  ExpectError(ErrorCode::kMismatch, {"cam1", "v1.jpg", "focal length"}, [&] {
    CheckCameras(cameras, model, 1.0);
  });
}

TEST(CheckCameras, AcceptsASingleImage) {
  const SparseModel model = MakeModel(1, 0.0, 0.0);
  CheckCameras(CamerasOf(model), model, 1.0);
}

}  // namespace
}  // namespace tsar
