// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/tools/export/export_fixture.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/image_maps.h"

#include <cstdio>
#include <sstream>

#include "tests/support/mask_files.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/write_refined.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {

const std::vector<std::string>& ExportTest::Names() {
  static const std::vector<std::string> names = {
      "a.1.png", "left/b.png", "c.png"};
  return names;
}

Eigen::Isometry3d ExportTest::Pose(int image) {
  const Eigen::Vector3d axis(0.3, 1.0, -0.2 * image);
  Eigen::Isometry3d pose(Eigen::AngleAxisd(0.4 + image, axis.normalized()));
  pose.translation() = Eigen::Vector3d(1.0 - image, 0.5, 0.25 * image);
  return pose;
}

float ExportTest::Depth(int image, int x, int y) {
  return x == 1 && y == 2 ? 0.f
                          : 2.f + 0.1f * static_cast<float>(x) +
                                0.37f * static_cast<float>(y + image);
}

Vec3f ExportTest::Normal(int x, int y) {
  return Normalized(
      Vec3f{0.1f * static_cast<float>(x), -0.2f * static_cast<float>(y), -1.f});
}

Eigen::Vector3d ExportTest::Point(int image, int x, int y) {
  const double z = Depth(image, x, y);
  // COLMAP scales all intrinsics, and has no half pixel here.
  const Eigen::Vector3d point(
      z * (x - kCx / 2.0) / (kFx / 2.0), z * (y - kCy / 2.0) / (kFy / 2.0), z);
  return Pose(image).inverse() * point;
}

void ExportTest::SetUp() {
  std::ostringstream cameras;
  cameras << "1 PINHOLE 8 6 " << kFx << " " << kFy << " " << kCx << " " << kCy
          << "\n";
  WriteText(root_ / "sparse/cameras.txt", cameras.str());
  std::ostringstream images;
  images.precision(17);
  for (int i = 0; i < 3; ++i) {
    const Eigen::Quaterniond q(Pose(i).rotation());
    const Eigen::Vector3d t = Pose(i).translation();
    images << i + 1 << " " << q.w() << " " << q.x() << " " << q.y() << " "
           << q.z() << " " << t.x() << " " << t.y() << " " << t.z() << " 1 "
           << Names()[i] << "\n\n";
    const std::filesystem::path photo = root_ / "images" / Names()[i];
    std::filesystem::create_directories(photo.parent_path());
    ASSERT_TRUE(cv::imwrite(photo.string(),
                            cv::Mat(6, 8, CV_8UC3, cv::Scalar(i, 2, 3))));
  }
  WriteText(root_ / "sparse/images.txt", images.str());
  WriteText(root_ / "sparse/points3D.txt", "1 0 0 5 0 0 0 0 1 0 2 0\n");
  WriteText(root_ / "stereo/patch-match.cfg",
            "a.1.png\n__all__\nleft/b.png\n__all__\n");
  Image<Vec3f> normal(kWidth, kHeight);
  for (int i = 0; i < 2; ++i) {
    Image<float> depth(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        depth(x, y) = Depth(i, x, y);
        normal(x, y) = depth(x, y) > 0.f ? Normal(x, y) : Vec3f{};
      }
    }
    const MapPaths paths = GetMapPaths(root_, Names()[i], MapType::kGeometric);
    CreateFolders(paths.depth.Parent());
    CreateFolders(paths.normal.Parent());
    WriteDepthMap(paths.depth, depth);
    WriteNormalMap(paths.normal, normal);
    if (i == 0) {
      RefinedMaps maps = MakeRefinedMaps(9.f);
      maps.depth = depth;
      maps.normal = normal;
      maps.planes = Image<uint16_t>(kWidth, kHeight, 700);
      maps.sigma = Image<uint16_t>(kWidth, kHeight, ToPositiveHalf(0.0625f));
      WriteRefined(Workspace(root_, MapType::kGeometric), 0, maps, {});
    }
  }
  options_.output_path = folder_.Path() / "exported";
}

void ExportTest::UseMask(int width,
                         int height,
                         const std::function<bool(int x, int y)>& is_masked) {
  options_.mask_path = folder_.Path() / "masks";
  WriteMask(
      options_.mask_path / (Names()[0] + ".png"), width, height, is_masked);
}

ExportSummary ExportTest::Export(ExportFormat format) const {
  ExportOptions options = options_;
  options.format = format;
  std::ostringstream out;
  Progress progress(out, false);
  return ExportWorkspace(
      OpenWorkspaceWithMaps(root_, std::nullopt), options, progress, [] {
        return false;
      });
}

nlohmann::json ExportTest::ReadJson(const std::string& name) const {
  return nlohmann::json::parse(ReadText(options_.output_path / name));
}

nlohmann::json ExportTest::ImageEntry(const std::string& name) const {
  const nlohmann::json manifest = ReadJson("manifest.json");
  for (const nlohmann::json& entry : manifest["images"]) {
    if (entry["name"] == name) {
      return entry;
    }
  }
  ADD_FAILURE() << name << " is not in the manifest";
  return {};
}

void ExportTest::ExpectFailure(ErrorCode code,
                               const std::vector<std::string>& texts) {
  const auto before = ReadTree(folder_.Path());
  ExpectError(code, texts, [&] { Export(options_.format); });
  EXPECT_TRUE(ReadTree(folder_.Path()) == before);
}

Eigen::Vector3d ExportTest::PointOf(const nlohmann::json& entry,
                                    int x,
                                    int y,
                                    double depth) {
  const nlohmann::json& camera = entry["camera"];
  EXPECT_EQ(camera["model"], "PINHOLE");
  const auto value = [&](const char* key) { return camera[key].get<double>(); };
  const Eigen::Vector4d point(depth * (x - value("cx")) / value("fx"),
                              depth * (y - value("cy")) / value("fy"),
                              depth,
                              1.0);
  const auto matrix = [&](const char* key) {
    Eigen::Matrix4d m;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) {
        m(row, column) = entry[key][row][column].get<double>();
      }
    }
    return m;
  };
  const Eigen::Vector4d world = matrix("camera_to_world") * point;
  EXPECT_LT((matrix("world_to_camera") * world - point).norm(), 1e-9);
  return world.head<3>();
}

NumpyArray ReadNumpyArray(const std::filesystem::path& path) {
  const std::string text = ReadText(path);
  EXPECT_EQ(text.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const size_t length =
      static_cast<uint8_t>(text[8]) + 256 * static_cast<uint8_t>(text[9]);
  const std::string header = text.substr(10, length);
  EXPECT_EQ((10 + length) % 64, 0u);
  EXPECT_EQ(header.back(), '\n');
  char type[8] = "";
  int end = 0;
  std::sscanf(header.c_str(),
              "{'descr': '%7[^']', 'fortran_order': False, 'shape': (%n",
              type,
              &end);
  EXPECT_GT(end, 0) << header;
  NumpyArray array;
  array.type = type;
  std::istringstream shape(header.substr(static_cast<size_t>(end)));
  size_t num_values = 1;
  for (int side = 0; shape >> side; shape.ignore(2)) {
    array.shape.push_back(side);
    num_values *= static_cast<size_t>(side);
    if (shape.peek() == ')') {
      break;
    }
  }
  array.bytes = text.substr(10 + length);
  EXPECT_EQ(array.bytes.size(),
            num_values * static_cast<size_t>(array.type.back() - '0'));
  return array;
}

}  // namespace tsar
