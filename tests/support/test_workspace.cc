// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/support/test_workspace.h"

#include "colmap_tsar/io/map_io.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {

TemporaryFolder::TemporaryFolder() {
  std::string name =
      (std::filesystem::temp_directory_path() / "tsar_test_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("cannot make a folder for the test");
  }
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

void WriteText(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  // A new file rather than the old one with new content: other hard links keep
  // theirs.
  std::filesystem::remove(path);
  std::ofstream(path, std::ios::binary) << text;
}

std::string ReadText(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file.is_open()) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void MakeTestWorkspace(const std::filesystem::path& root) {
  WriteText(root / "sparse/cameras.txt", "1 PINHOLE 8 6 10 10 4 3\n");
  WriteText(root / "sparse/images.txt",
            "1 1 0 0 0 0 0 0 1 a.png\n\n"
            "2 1 0 0 0 -1 0 0 1 left/b.png\n\n"
            "3 1 0 0 0 -2 0 0 1 c.png\n\n");
  WriteText(root / "sparse/points3D.txt",
            "1 0 0 5 0 0 0 0 1 0 2 0\n2 1 0 5 0 0 0 0 1 1 2 1 3 0\n");
  WriteText(root / "stereo/patch-match.cfg",
            "a.png\n__auto__, 20\nleft/b.png\na.png, c.png\nc.png\n__all__\n");
  WriteText(root / "stereo/fusion.cfg", "a.png\nleft/b.png\nc.png\n");
  float depth = 1.f;
  for (const char* image : {"a.png", "left/b.png", "c.png"}) {
    const std::filesystem::path path = root / "images" / image;
    std::filesystem::create_directories(path.parent_path());
    cv::Mat pixels(6, 8, CV_8UC3);
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 8; ++x) {
        pixels.at<cv::Vec3b>(y, x) = {static_cast<uchar>(x),
                                      static_cast<uchar>(10 * y),
                                      static_cast<uchar>(200)};
      }
    }
    ASSERT_TRUE(cv::imwrite(path.string(), pixels));
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      WriteTestMaps(root, image, type, depth);
      depth += 1.f;
    }
  }
}

void WriteTestMaps(const std::filesystem::path& root,
                   const std::string& image,
                   MapType type,
                   float depth) {
  const MapPaths paths = GetMapPaths(root, image, type);
  CreateFolders(paths.depth.Parent());
  CreateFolders(paths.normal.Parent());
  WriteDepthMap(paths.depth, Image<float>(4, 3, depth));
  WriteNormalMap(paths.normal, Image<Vec3f>(4, 3, Vec3f{0.f, 0.f, -depth}));
  // The file system's clock may not advance between two writes of a test.
  static int num_seconds = 0;
  for (const ContainedPath& path : {paths.depth, paths.normal}) {
    std::filesystem::last_write_time(
        path,
        std::filesystem::file_time_type::clock::now() +
            std::chrono::seconds(++num_seconds));
  }
}

RefinedMaps MakeRefinedMaps(float depth, int width, int height) {
  return {Image<float>(width, height, depth),
          Image<Vec3f>(width, height, Vec3f{0.f, 0.f, -1.f}),
          Image<uint8_t>(width, height, ToConfidenceLevel(0.5f)),
          Image<uint8_t>(width, height, 4)};
}

void ExpectError(ErrorCode code,
                 const std::vector<std::string>& texts,
                 const std::function<void()>& function) {
  try {
    function();
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.Code()), static_cast<int>(code))
        << error.what();
    for (const std::string& text : texts) {
      EXPECT_THAT(error.what(), testing::HasSubstr(text));
    }
    EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    return;
  }
  ADD_FAILURE() << "no error was thrown";
}

}  // namespace tsar
