// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/support/room_workspace.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/run/store/write_back.h"

#include <array>
#include <string>
#include <vector>

#include "tests/support/scene_model_testing.h"
#include "tests/support/synthetic_observations.h"
#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

constexpr double kFocalLength = 160.0;

// A plane in the room's coordinates; the normal may point outwards.
struct RoomPlane {
  Eigen::Vector3d normal;
  Eigen::Vector3d point;
};
const std::array<RoomPlane, RoomWorkspace::kNumPlanes>& RoomPlanes() {
  static const std::array<RoomPlane, RoomWorkspace::kNumPlanes> planes = {
      {{{0, 1, 0}, {2, 1.25, 2}},
       {{0, 1, 0}, {2, -1.25, 2}},
       {{1, 0, 0}, {0, 0, 2}},
       {{1, 0, 0}, {5, 0, 2}},
       {{0, 0, -1}, {2, 0, 0}},
       {{0, 0, -1}, {2, 0, 4}},
       {{1, 1, 1}, {50, 50, 50}}}};
  return planes;
}

bool IsWindow(const Eigen::Vector3d& point) {
  return point.z() > 3.9 && point.x() > 1.5 && point.x() < 3.0 &&
         point.y() > -0.6 && point.y() < 0.5;
}

// In the room's coordinates.
std::vector<Camera> RoomCameras() {
  std::vector<Camera> cameras;
  for (const double x : {0.5, 4.5}) {
    for (const double z : {0.5, 3.5}) {
      for (const double y : {-1.0, 1.0}) {
        Camera camera = CameraLookingAt({x, 0.0, z}, {2.5, y, 2.0});
        camera.width = RoomWorkspace::kWidth;
        camera.height = RoomWorkspace::kHeight;
        camera.fx = camera.fy = kFocalLength;
        camera.cx = 0.5 * camera.width;
        camera.cy = 0.5 * camera.height;
        cameras.push_back(camera);
      }
    }
  }
  return cameras;
}

std::string ImageName(size_t image) {
  std::string name = "v";
  name += std::to_string(image);
  name += ".png";
  return name;
}

// What the camera sees, without normals.
RefinedMaps Draw(const Camera& camera, int num_wrong_per_mille) {
  std::vector<WorldPlane> surfaces;
  for (int p = 0; p < RoomWorkspace::kUnseen; ++p) {
    const RoomPlane& surface = RoomPlanes()[p];
    surfaces.push_back(PlaneThrough(surface.normal, surface.point));
  }
  Philox random(static_cast<uint32_t>(num_wrong_per_mille), 1, 2);
  RefinedMaps maps;
  maps.depth = Image<float>(camera.width, camera.height);
  maps.normal = Image<Vec3f>(camera.width, camera.height, Vec3f{0, 0, -1});
  maps.confidence =
      Image<uint8_t>(camera.width, camera.height, ToConfidenceLevel(0.5f));
  maps.provenance = Image<uint8_t>(camera.width, camera.height);
  maps.planes = Image<uint16_t>(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray(
          (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
      DepthObservation nearest;
      nearest.depth = 1e9;
      int plane = 0;
      for (int p = 0; p < RoomWorkspace::kUnseen; ++p) {
        const DepthObservation hit = ObservePlane(surfaces[p], camera, ray);
        if (hit.depth > 0.0 && hit.depth < nearest.depth) {
          nearest = hit;
          plane = p;
        }
      }
      if (IsWindow(nearest.Point())) {
        continue;
      }
      maps.depth(x, y) = static_cast<float>(nearest.depth);
      maps.provenance(x, y) = static_cast<uint8_t>(
          x % 4 == 0 ? Provenance::kInterpolated : Provenance::kMeasured);
      const bool is_wrong =
          1000.f * random.NextFloat() < static_cast<float>(num_wrong_per_mille);
      maps.planes(x, y) = static_cast<uint16_t>(
          1 + (is_wrong ? (plane + x) % RoomWorkspace::kUnseen : plane));
    }
  }
  return maps;
}

}  // namespace

RoomWorkspace::RoomWorkspace(const std::filesystem::path& root) : root(root) {}

SceneModel RoomWorkspace::Model() const {
  SceneModel model;
  model.frames.push_back(pose.rotation());
  for (const RoomPlane& plane : RoomPlanes()) {
    model.planes.push_back(
        MakeModelPlane(pose.rotation() * plane.normal, pose * plane.point));
    model.planes.back().covariance << 1, 0.1, 0.2, 0.1, 2, 0.3, 0.2, 0.3, 3;
    model.planes.back().support = 100.0;
  }
  model.planes[kFloor].frame = 0;
  model.planes[kFloor].axis = 1;
  return model;
}

void RoomWorkspace::Write() const {
  std::filesystem::create_directories(root / "images");
  TextStream images;
  TextStream config;
  images.precision(17);
  const std::vector<Camera> cameras = RoomCameras();
  for (size_t i = 0; i < cameras.size(); ++i) {
    const Eigen::Matrix3d rotation =
        cameras[i].rotation * pose.rotation().transpose();
    const Eigen::Vector3d translation =
        -rotation * (pose * cameras[i].Center());
    const Eigen::Quaterniond q(rotation);
    images << i + 1 << " " << q.w() << " " << q.x() << " " << q.y() << " "
           << q.z() << " " << translation.x() << " " << translation.y() << " "
           << translation.z() << " 1 " << ImageName(i) << "\n\n";
    config << ImageName(i) << "\n__all__\n";
    cv::imwrite((root / "images" / ImageName(i)).string(),
                cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(9, 8, 7)));
  }
  WriteText(root / "sparse/cameras.txt", "1 PINHOLE 320 240 160 160 160 120\n");
  WriteText(root / "sparse/images.txt", images.str());
  WriteText(root / "sparse/points3D.txt", "");
  WriteText(root / "stereo/patch-match.cfg", config.str());
  for (size_t i = 0; i < cameras.size(); ++i) {
    const MapPaths paths = GetMapPaths(root, ImageName(i), MapType::kGeometric);
    CreateFolders(paths.depth.Parent());
    CreateFolders(paths.normal.Parent());
    WriteDepthMap(paths.depth, Image<float>(kWidth, kHeight, 1.f));
    WriteNormalMap(paths.normal,
                   Image<Vec3f>(kWidth, kHeight, Vec3f{0, 0, -1}));
  }
  const Workspace workspace(root, MapType::kGeometric);
  for (size_t i = 0; i < cameras.size(); ++i) {
    WriteRefined(workspace,
                 static_cast<int>(i),
                 Draw(cameras[i], num_wrong_per_mille),
                 {});
  }
  WriteSceneModel(GetSceneModelPath(root), "options", Model());
}

}  // namespace tsar
