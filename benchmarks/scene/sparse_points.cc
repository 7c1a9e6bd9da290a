// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/scene/sparse_points.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace tsar {
namespace {

// Two points this close along a ray are the same.
constexpr double kSameDepth = 1e-3;
constexpr int kMaxTriesPerPoint = 20;

std::vector<SparsePoint::Observation> FindTrack(
    const Room& room,
    const std::vector<Camera>& cameras,
    const Eigen::Vector3d& position) {
  std::vector<SparsePoint::Observation> track;
  for (size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i];
    const Eigen::Vector3d local =
        camera.rotation * position + camera.translation;
    if (!(local.z() > 0.0)) {
      continue;
    }
    const double x = camera.fx * local.x() / local.z() + camera.cx;
    const double y = camera.fy * local.y() / local.z() + camera.cy;
    if (!(x >= 0.0 && y >= 0.0 && x <= camera.width - 1 &&
          y <= camera.height - 1)) {
      continue;
    }
    const RoomHit hit = room.Cast(PixelRay(camera, x, y));
    if (std::abs(hit.point.distance - local.z()) <= kSameDepth * local.z()) {
      track.push_back({static_cast<int>(i), x, y});
    }
  }
  return track;
}

std::ostream& TextStream(AtomicFile& file) {
  file.Stream().precision(17);
  return file.Stream();
}

void WriteCameras(const std::filesystem::path& path,
                  const std::vector<Camera>& cameras) {
  AtomicFile file(UserPath(path));
  std::ostream& out = TextStream(file);
  for (size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i];
    out << i + 1 << " PINHOLE " << camera.width << " " << camera.height << " "
        << camera.fx << " " << camera.fy << " " << camera.cx << " " << camera.cy
        << "\n";
  }
  file.Commit();
}

}  // namespace

std::vector<SparsePoint> SampleSparsePoints(const Room& room,
                                            const std::vector<Camera>& cameras,
                                            int num_points,
                                            int min_track_length,
                                            uint32_t seed) {
  std::vector<SparsePoint> points;
  Philox random(seed, 0, 3);
  const int num_tries = kMaxTriesPerPoint * num_points;
  for (int i = 0; i < num_tries && static_cast<int>(points.size()) < num_points;
       ++i) {
    const Camera& camera = cameras[static_cast<size_t>(i) % cameras.size()];
    const double x = random.NextFloat() * (camera.width - 1);
    const double y = random.NextFloat() * (camera.height - 1);
    const Ray ray = PixelRay(camera, x, y);
    const RoomHit hit = room.Cast(ray);
    if (room.IsBare(hit)) {
      continue;
    }
    SparsePoint point;
    point.position = ray.origin + hit.point.distance * ray.direction;
    point.track = FindTrack(room, cameras, point.position);
    if (static_cast<int>(point.track.size()) >= min_track_length) {
      points.push_back(std::move(point));
    }
  }
  return points;
}

void WriteSparseModel(const std::filesystem::path& folder,
                      const std::vector<std::string>& names,
                      const std::vector<Camera>& cameras,
                      const std::vector<SparsePoint>& points) {
  CreateFolders(UserPath(folder));
  WriteCameras(folder / "cameras.txt", cameras);

  // Points of each image, in the order of the points.
  std::vector<std::string> observations(cameras.size());
  std::vector<int> num_observations(cameras.size(), 0);
  AtomicFile points_file(UserPath(folder / "points3D.txt"));
  std::ostream& out = TextStream(points_file);
  for (size_t k = 0; k < points.size(); ++k) {
    const SparsePoint& point = points[k];
    out << k + 1 << " " << point.position.x() << " " << point.position.y()
        << " " << point.position.z() << " 128 128 128 0.3";
    for (const SparsePoint::Observation& seen : point.track) {
      const auto image = static_cast<size_t>(seen.image);
      out << " " << image + 1 << " " << num_observations[image]++;
      observations[image] += std::to_string(seen.x) + " " +
                             std::to_string(seen.y) + " " +
                             std::to_string(k + 1) + " ";
    }
    out << "\n";
  }
  points_file.Commit();

  AtomicFile images_file(UserPath(folder / "images.txt"));
  std::ostream& images = TextStream(images_file);
  for (size_t i = 0; i < cameras.size(); ++i) {
    const Eigen::Quaterniond q(cameras[i].rotation);
    const Eigen::Vector3d& t = cameras[i].translation;
    images << i + 1 << " " << q.w() << " " << q.x() << " " << q.y() << " "
           << q.z() << " " << t.x() << " " << t.y() << " " << t.z() << " "
           << i + 1 << " " << names[i] << "\n"
           << observations[i] << "\n";
  }
  images_file.Commit();
}

}  // namespace tsar
