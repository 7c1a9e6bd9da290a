// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/scene/room_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_paths.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "benchmarks/scene/render.h"
#include "benchmarks/scene/simulated_stereo.h"
#include "benchmarks/scene/sparse_points.h"
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

constexpr int kJpegQuality = 95;
constexpr int kMinTrackLength = 3;
constexpr int kMinPoints = 4000;
constexpr int kPointsPerImage = 300;

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

void WriteJpeg(const std::filesystem::path& path, const Image<Rgb>& color) {
  const cv::Mat rgb(
      color.Height(), color.Width(), CV_8UC3, const_cast<Rgb*>(color.Data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  if (!cv::imwrite(
          path.string(), bgr, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality})) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "the image cannot be written",
                      "check the folder and the space on its disk");
  }
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
  WriteSparseModel(
      root / "sparse",
      names,
      cameras,
      SampleSparsePoints(
          room, cameras, num_points, kMinTrackLength, options.seed));
  WriteConfigs(root / "stereo", names, cameras, options.num_sources);
  for (size_t i = 0; i < cameras.size(); ++i) {
    const auto key = options.seed + 7919u * static_cast<uint32_t>(i + 1);
    const RenderedView view = RenderView(room, cameras[i], key, threads);
    WriteView(root, names[i], view, SimulateStereoMaps(view, key, threads));
    advance();
  }
}

}  // namespace tsar
