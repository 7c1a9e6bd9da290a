// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/support/synthetic_workspace.h"

#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_paths.h"

#include <cmath>
#include <cstdint>
#include <sstream>

#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

constexpr double kFocalLength = 80.0;
constexpr double kBaseline = 0.4;

// A number in [0, 1) for each pair of integers.
double Noise(int a, int b) {
  uint32_t hash = static_cast<uint32_t>(a) * 0x9E3779B1u ^
                  static_cast<uint32_t>(b) * 0x85EBCA77u;
  hash = (hash ^ (hash >> 15)) * 0x2C1B3C6Du;
  hash = (hash ^ (hash >> 12)) * 0x297A2D39u;
  return static_cast<double>(hash ^ (hash >> 15)) / 4294967296.0;
}

// Noise with soft transitions.
double Texture(double x, double y) {
  constexpr double kCell = 0.14;
  const double column = std::floor(x / kCell);
  const double row = std::floor(y / kCell);
  const double u = x / kCell - column;
  const double v = y / kCell - row;
  const int c = static_cast<int>(column);
  const int r = static_cast<int>(row);
  return (1 - v) * ((1 - u) * Noise(c, r) + u * Noise(c + 1, r)) +
         v * ((1 - u) * Noise(c, r + 1) + u * Noise(c + 1, r + 1));
}

// Where on the wall a pixel looks, in units of the scale.
double WallX(int view, int x) {
  return SyntheticWorkspace::kDepth * (x - SyntheticWorkspace::kWidth / 2) /
             kFocalLength +
         kBaseline * view;
}
double WallY(int y) {
  return SyntheticWorkspace::kDepth * (y - SyntheticWorkspace::kHeight / 2) /
         kFocalLength;
}

cv::Mat DrawImage(int view) {
  cv::Mat pixels(
      SyntheticWorkspace::kHeight, SyntheticWorkspace::kWidth, CV_8UC3);
  for (int y = 0; y < pixels.rows; ++y) {
    for (int x = 0; x < pixels.cols; ++x) {
      const double gray =
          SyntheticWorkspace::IsBare(view, x, y)
              ? 200.0
              : 20.0 + 160.0 * Texture(WallX(view, x), WallY(y));
      const auto level = static_cast<uchar>(std::lround(gray));
      pixels.at<cv::Vec3b>(y, x) = {level, level, level};
    }
  }
  return pixels;
}

Image<float> DrawDepth(int view, MapType type, double scale) {
  Image<float> depth(SyntheticWorkspace::kWidth, SyntheticWorkspace::kHeight);
  for (int y = 0; y < depth.Height(); ++y) {
    for (int x = 0; x < depth.Width(); ++x) {
      const double noise = Noise(1000 * (view + 1) + x, y) - 0.5;
      const bool is_wrong =
          type == MapType::kPhotometric || Noise(x, 777 * (view + 1) + y) < 0.1;
      const double error = !SyntheticWorkspace::IsBare(view, x, y)
                               ? 0.002 * noise
                           : is_wrong ? 0.4 * noise
                                      : -1.0;
      depth(x, y) = static_cast<float>(SyntheticWorkspace::kDepth * scale *
                                       (1.0 + error));
    }
  }
  return depth;
}

void WriteMaps(const std::filesystem::path& root, int view, double scale) {
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    const MapPaths paths =
        GetMapPaths(root, SyntheticWorkspace::Names()[view], type);
    CreateFolders(paths.depth.Parent());
    CreateFolders(paths.normal.Parent());
    const Image<float> depth = DrawDepth(view, type, scale);
    Image<Vec3f> normal(depth.Width(), depth.Height());
    for (size_t i = 0; i < depth.NumPixels(); ++i) {
      normal.Data()[i] = Vec3f{0.f, 0.f, depth.Data()[i] > 0.f ? -1.f : 0.f};
    }
    WriteDepthMap(paths.depth, depth);
    WriteNormalMap(paths.normal, normal);
  }
}

}  // namespace

const std::vector<std::string>& SyntheticWorkspace::Names() {
  static const std::vector<std::string> names = {
      "v0.png", "v1.png", "left/v2.png", "v3.png"};
  return names;
}

bool SyntheticWorkspace::IsBare(int view, int x, int y) {
  return std::abs(WallX(view, x) - 0.6) < 1.1 && std::abs(WallY(y)) < 1.1;
}

void MakeSyntheticWorkspace(const std::filesystem::path& root, double scale) {
  WriteText(root / "sparse/cameras.txt", "1 PINHOLE 96 72 80 80 48 36\n");
  WriteText(root / "sparse/points3D.txt", "");
  std::ostringstream images;
  images.precision(17);
  std::string config;
  std::string fusion;
  for (int view = 0; view < 4; ++view) {
    const std::string& name = SyntheticWorkspace::Names()[view];
    images << view + 1 << " 1 0 0 0 " << -kBaseline * view * scale << " 0 0 1 "
           << name << "\n\n";
    config += name + "\n__all__\n";
    fusion += name + "\n";
    const std::filesystem::path path = root / "images" / name;
    std::filesystem::create_directories(path.parent_path());
    ASSERT_TRUE(cv::imwrite(path.string(), DrawImage(view)));
    WriteMaps(root, view, scale);
  }
  WriteText(root / "sparse/images.txt", images.str());
  WriteText(root / "stereo/patch-match.cfg", config);
  WriteText(root / "stereo/fusion.cfg", fusion);
}

void WriteOtherConventions(const std::filesystem::path& root, float no_depth) {
  for (const std::string& name : SyntheticWorkspace::Names()) {
    const MapPaths paths = GetMapPaths(root, name, MapType::kGeometric);
    Image<float> depth = ReadDepthMap(paths.depth);
    std::fill_n(depth.Data(), 20 * depth.Width(), no_depth);
    WriteDepthMap(paths.depth, depth);
    Image<Vec3f> normal = ReadNormalMap(paths.normal);
    for (Vec3f& n : normal) {
      n = no_depth > 0.f ? -n : n;
    }
    WriteNormalMap(paths.normal, normal);
  }
}

std::map<std::string, std::string> ReadTree(const std::filesystem::path& root) {
  std::map<std::string, std::string> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(root)) {
    files[entry.path().lexically_relative(root).string()] =
        entry.is_directory() ? "folder" : ReadText(entry.path());
  }
  return files;
}

}  // namespace tsar
