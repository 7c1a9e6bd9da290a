// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/support/column_workspace.h"

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/random.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_paths.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <vector>

#include "tests/support/drawn_column.h"
#include "tests/support/pixel_mean.h"
#include "tests/support/test_workspace.h"
#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

constexpr double kFocal = 147.0;
// Samples per pixel and direction, for the column's outlines and texture.
constexpr int kOutlineSamples = 4;
constexpr int kTextureSamples = 2;
// Half the width of the matching windows of the simulated stereo.
constexpr int kWindow = 6;

// Planes of the room: a point on each, and its normal.
struct RoomPlane {
  Eigen::Vector3d normal;
  double offset;  // normal.dot(point) = offset.
};
const std::vector<RoomPlane>& Room() {
  static const std::vector<RoomPlane> room = {{-Eigen::Vector3d::UnitY(), -4.5},
                                              {Eigen::Vector3d::UnitX(), -1.6},
                                              {Eigen::Vector3d::UnitZ(), -0.9}};
  return room;
}

Camera CameraOf(int view) {
  const double angle = 0.9 * (view / (ColumnWorkspace::kNumViews - 1.0) - 0.5);
  const Eigen::Vector3d from(3.0 * std::sin(angle),
                             3.0 - 3.0 * std::cos(angle),
                             0.15 + 0.1 * (view % 3 - 1));
  const Eigen::Vector3d forward =
      (Eigen::Vector3d(0.1 * (view % 3 - 1), 3.0, -0.05) - from).normalized();
  const Eigen::Vector3d right =
      forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Camera camera;
  camera.width = ColumnWorkspace::kWidth;
  camera.height = ColumnWorkspace::kHeight;
  camera.fx = camera.fy = kFocal;
  // As in COLMAP's dense stage, pixel centers have integer coordinates.
  camera.cx = 0.5 * ColumnWorkspace::kWidth;
  camera.cy = 0.5 * ColumnWorkspace::kHeight;
  camera.rotation.row(0) = right;
  camera.rotation.row(1) = forward.cross(right);
  camera.rotation.row(2) = forward;
  camera.translation = -camera.rotation * from;
  return camera;
}

Eigen::Vector3d RayAt(const Camera& camera, double x, double y) {
  return camera.rotation.transpose() *
         Eigen::Vector3d(
             (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
}

// The plane of the room that a ray hits, and its depth.
const RoomPlane& RoomAt(const Eigen::Vector3d& from,
                        const Eigen::Vector3d& ray,
                        double* depth) {
  const RoomPlane* nearest = &Room()[0];
  *depth = 1e9;
  for (const RoomPlane& plane : Room()) {
    const double of_plane =
        (plane.offset - plane.normal.dot(from)) / plane.normal.dot(ray);
    if (of_plane > 0.0 && of_plane < *depth) {
      *depth = of_plane;
      nearest = &plane;
    }
  }
  return *nearest;
}

bool IsColumn(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  return DrawnColumn()(from, ray) == DrawnColumn::kColumn;
}

double ColumnDepth(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  const DrawnColumn column;
  const Eigen::Vector2d across = ray.head<2>();
  const Eigen::Vector2d to_center = column.center - from.head<2>();
  const double a = across.squaredNorm();
  const double b = across.dot(to_center);
  const double c = to_center.squaredNorm() - column.radius * column.radius;
  return (b - std::sqrt(b * b - a * c)) / a;
}

// A number in [0, 1) for each cell of the room.
double Noise(int i, int j, int k) {
  Philox random(static_cast<uint32_t>(i),
                static_cast<uint32_t>(j),
                static_cast<uint32_t>(k));
  return random.NextFloat();
}

// Soft, of gray levels between those of the column and of black.
double Texture(const Eigen::Vector3d& point) {
  constexpr double kCell = 0.07;
  const Eigen::Vector3d cells = point / kCell;
  const Eigen::Array3d low = cells.array().floor();
  const Eigen::Array3d share = cells.array() - low;
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    int cell[3];
    for (int i = 0; i < 3; ++i) {
      const int bit = corner >> i & 1;
      weight *= bit == 1 ? share[i] : 1.0 - share[i];
      cell[i] = static_cast<int>(low[i]) + bit;
    }
    sum += weight * Noise(cell[0], cell[1], cell[2]);
  }
  return 20.0 + 100.0 * sum;
}

double RoomGray(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  double depth = 0.0;
  RoomAt(from, ray, &depth);
  return Texture(from + depth * ray);
}

void WriteImage(const std::filesystem::path& path, const Camera& camera) {
  cv::Mat pixels(camera.height, camera.width, CV_8UC3);
  const Eigen::Vector3d from = camera.Center();
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto ray = [&](int i, int j, int samples) {
        return RayAt(camera,
                     x - 0.5 + (i + 0.5) / samples,
                     y - 0.5 + (j + 0.5) / samples);
      };
      const double column = PixelMean<kOutlineSamples>([&](int i, int j) {
        return IsColumn(from, ray(i, j, kOutlineSamples)) ? 1.0 : 0.0;
      });
      const double room =
          column == 1.0 ? 0.0 : PixelMean<kTextureSamples>([&](int i, int j) {
            return RoomGray(from, ray(i, j, kTextureSamples));
          });
      const auto level = static_cast<uchar>(
          std::lround(column * 220.0 + (1.0 - column) * room));
      pixels.at<cv::Vec3b>(y, x) = {level, level, level};
    }
  }
  std::filesystem::create_directories(path.parent_path());
  ASSERT_TRUE(cv::imwrite(path.string(), pixels));
}

void WriteMaps(const std::filesystem::path& root, int view) {
  const Camera camera = CameraOf(view);
  Image<float> depth(camera.width, camera.height);
  Image<Vec3f> normal(camera.width, camera.height);
  const Eigen::Vector3d from = camera.Center();
  Philox random(static_cast<uint32_t>(view), 1, 2);
  for (int y = 0; y < camera.height; ++y) {
    std::vector<bool> of_row;
    for (int x = -kWindow; x < camera.width + kWindow; ++x) {
      of_row.push_back(IsColumn(from, RayAt(camera, x, y)));
    }
    for (int x = 0; x < camera.width; ++x) {
      double of_room = 0.0;
      const RoomPlane& plane = RoomAt(from, RayAt(camera, x, y), &of_room);
      const double truth = of_row[x + kWindow]
                               ? ColumnDepth(from, RayAt(camera, x, y))
                               : of_room;
      const auto window = of_row.begin() + x;
      const bool is_wrong = std::find(window, window + 2 * kWindow + 1, true) !=
                            window + 2 * kWindow + 1;
      const double size = is_wrong ? 0.4 : 0.002;
      depth(x, y) =
          static_cast<float>(truth * (1.0 + size * (random.NextFloat() - 0.5)));
      const Eigen::Vector3f in_view =
          (camera.rotation * plane.normal).cast<float>();
      normal(x, y) = {in_view.x(), in_view.y(), in_view.z()};
    }
  }
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    const MapPaths paths = GetMapPaths(root, ColumnWorkspace::Name(view), type);
    CreateFolders(paths.depth.Parent());
    CreateFolders(paths.normal.Parent());
    WriteDepthMap(paths.depth, depth);
    WriteNormalMap(paths.normal, normal);
  }
}

}  // namespace

std::string ColumnWorkspace::Name(int view) {
  std::string name = "c";
  name += std::to_string(view);
  name += ".png";
  return name;
}

double ColumnWorkspace::Depth(int view, int x, int y, bool* is_column) {
  const Camera camera = CameraOf(view);
  const Eigen::Vector3d from = camera.Center();
  const Eigen::Vector3d ray = RayAt(camera, x, y);
  *is_column = IsColumn(from, ray);
  double depth = 0.0;
  RoomAt(from, ray, &depth);
  return *is_column ? ColumnDepth(from, ray) : depth;
}

void MakeColumnWorkspace(const std::filesystem::path& root) {
  WriteText(root / "sparse/cameras.txt", "1 PINHOLE 160 120 147 147 80 60\n");
  WriteText(root / "sparse/points3D.txt", "");
  std::ostringstream images;
  images.precision(17);
  std::string config;
  std::string fusion;
  for (int view = 0; view < ColumnWorkspace::kNumViews; ++view) {
    const std::string name = ColumnWorkspace::Name(view);
    const Camera camera = CameraOf(view);
    const Eigen::Quaterniond q(camera.rotation);
    images << view + 1 << " " << q.w() << " " << q.x() << " " << q.y() << " "
           << q.z() << " " << camera.translation.transpose() << " 1 " << name
           << "\n\n";
    config += name + "\n__all__\n";
    fusion += name + "\n";
    WriteImage(root / "images" / name, camera);
    WriteMaps(root, view);
  }
  WriteText(root / "sparse/images.txt", images.str());
  WriteText(root / "stereo/patch-match.cfg", config);
  WriteText(root / "stereo/fusion.cfg", fusion);
}

}  // namespace tsar
