// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/scene/room_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/picture_file.h"
#include "colmap_tsar/base/random.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_paths.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/scene/simulated_views.h"
#include <Eigen/Geometry>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

constexpr int kJpegQuality = 95;
constexpr int kMinTrackLength = 3;
constexpr int kMinPoints = 4000;
constexpr int kMaxTriesPerPoint = 20;
constexpr int kPointsPerImage = 300;

// Two points this close along a ray are the same.
constexpr double kSameDepth = 1e-3;

// A point on a surface with texture, and the images that see it.
struct SparsePoint {
  struct Observation {
    int image = 0;
    double x = 0.0;
    double y = 0.0;
  };
  Eigen::Vector3d position;
  std::vector<Observation> track;
};

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

// Points under random pixels of all cameras that at least kMinTrackLength
// cameras see; fewer than num_points where such pixels are rare.
std::vector<SparsePoint> SampleSparsePoints(const Room& room,
                                            const std::vector<Camera>& cameras,
                                            int num_points,
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
    if (static_cast<int>(point.track.size()) >= kMinTrackLength) {
      points.push_back(std::move(point));
    }
  }
  return points;
}

// COLMAP's text form: cameras.txt, images.txt and points3D.txt.
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

std::vector<std::string> MakeNames(int num_images) {
  std::vector<std::string> names;
  for (int i = 0; i < num_images; ++i) {
    char name[32];
    std::snprintf(name, sizeof(name), "%05d.jpg", i);
    names.emplace_back(name);
  }
  return names;
}

void WriteText(const std::filesystem::path& path, const std::string& text) {
  AtomicFile file(UserPath(path));
  file.Stream() << text;
  file.Commit();
}

// The cameras nearest to one of them, nearest first.
std::vector<size_t> NearestCameras(const std::vector<Camera>& cameras,
                                   size_t reference,
                                   int count) {
  std::vector<size_t> others(cameras.size());
  std::iota(others.begin(), others.end(), size_t{0});
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(reference));
  const Eigen::Vector3d center = cameras[reference].Center();
  std::stable_sort(others.begin(), others.end(), [&](size_t a, size_t b) {
    return (cameras[a].Center() - center).squaredNorm() <
           (cameras[b].Center() - center).squaredNorm();
  });
  others.resize(std::min(others.size(), static_cast<size_t>(count)));
  return others;
}

void WriteConfigs(const std::filesystem::path& stereo,
                  const std::vector<std::string>& names,
                  const std::vector<Camera>& cameras,
                  int num_sources) {
  std::string config;
  std::string fusion;
  for (size_t i = 0; i < names.size(); ++i) {
    std::string sources;
    for (const size_t source : NearestCameras(cameras, i, num_sources)) {
      sources += (sources.empty() ? "" : ", ") + names[source];
    }
    config += names[i] + "\n" + sources + "\n";
    fusion += names[i] + "\n";
  }
  WriteText(stereo / "patch-match.cfg", config);
  WriteText(stereo / "fusion.cfg", fusion);
}

void WriteJpeg(const ContainedPath& path, const Image<Rgb>& color) {
  const cv::Mat rgb(
      color.Height(), color.Width(), CV_8UC3, const_cast<Rgb*>(color.Data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  AtomicFile file(path);
  PutPicture(
      bgr, ".jpg", path, &file, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  file.Commit();
}

void WriteView(const std::filesystem::path& root,
               const std::string& name,
               const RenderedView& view,
               const SimulatedMaps& maps) {
  WriteJpeg(UserPath(root / "images" / name), view.color);
  WriteDepthMap(UserPath(root / "ground_truth" / "depth" / (name + ".bin")),
                view.depth);
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    const DepthNormal& map =
        type == MapType::kPhotometric ? maps.photometric : maps.geometric;
    const MapPaths paths = GetMapPaths(root, name, type);
    WriteDepthMap(paths.depth, map.depth);
    WriteNormalMap(paths.normal, map.normal);
  }
}

}  // namespace

void WriteRoomWorkspace(const std::filesystem::path& root,
                        const RoomWorkspaceOptions& options,
                        ThreadPool& threads,
                        const std::function<void()>& advance) {
  for (const char* folder : {"images",
                             "ground_truth/depth",
                             "stereo/depth_maps",
                             "stereo/normal_maps",
                             "stereo/consistency_graphs"}) {
    CreateFolders(UserPath(root / folder));
  }
  const Room room(options.seed);
  const std::vector<Camera> cameras =
      RoomCameras(options.num_images, options.width, options.height);
  const std::vector<std::string> names = MakeNames(options.num_images);
  const int num_points =
      std::max(kMinPoints, kPointsPerImage * options.num_images);
  WriteSparseModel(root / "sparse",
                   names,
                   cameras,
                   SampleSparsePoints(room, cameras, num_points, options.seed));
  WriteConfigs(root / "stereo", names, cameras, options.num_sources);
  for (size_t i = 0; i < cameras.size(); ++i) {
    const auto key = options.seed + 7919u * static_cast<uint32_t>(i + 1);
    const RenderedView view = RenderView(room, cameras[i], key, threads);
    WriteView(root, names[i], view, SimulateStereoMaps(view, key, threads));
    advance();
  }
}

}  // namespace tsar
