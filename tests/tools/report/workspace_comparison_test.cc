// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/write_back.h"
#include "colmap_tsar/tools/report/comparison_picture.h"

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/write_refined.h"
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 8;
constexpr int kHeight = 6;
constexpr float kOriginalDepth = 2.f;
constexpr float kRefinedDepth = 3.f;

// A workspace with the images 0.png, 1.png and 2.png, twice as large as their
// geometric maps.
class WorkspaceComparisonTest : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(::testing::TempDir()) /
            ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(root_);
    for (const char* folder :
         {"images", "sparse", "stereo/depth_maps", "stereo/normal_maps"}) {
      fs::create_directories(root_ / folder);
    }
    std::ofstream(root_ / "sparse/cameras.txt")
        << "1 PINHOLE 16 12 10 10 8 6\n";
    std::ofstream points(root_ / "sparse/points3D.txt");
    std::ofstream images(root_ / "sparse/images.txt");
    std::ofstream config(root_ / "stereo/patch-match.cfg");
    for (int i = 0; i < 3; ++i) {
      const std::string name = std::to_string(i) + ".png";
      images << i + 1 << " 1 0 0 0 " << i << " 0 0 1 " << name << "\n\n";
      config << name << "\n__all__\n";
      cv::imwrite(
          (root_ / "images" / name).string(),
          cv::Mat(2 * kHeight, 2 * kWidth, CV_8UC3, cv::Scalar(9, 8, 7)));
      const std::string tail = name + ".geometric.bin";
      WriteDepthMap(UserPath(root_ / "stereo/depth_maps" / tail),
                    Image<float>(kWidth, kHeight, kOriginalDepth));
      WriteNormalMap(UserPath(root_ / "stereo/normal_maps" / tail),
                     Image<Vec3f>(kWidth, kHeight, Vec3f{0.f, 0.f, -1.f}));
    }
  }
  void TearDown() override { fs::remove_all(root_); }

  void Refine(const Workspace& workspace, int image) {
    RefinedMaps maps;
    maps.depth = Image<float>(kWidth, kHeight, kRefinedDepth);
    maps.normal = Image<Vec3f>(kWidth, kHeight, Vec3f{0.f, -1.f, 0.f});
    maps.confidence = Image<float>(kWidth, kHeight, 1.f);
    maps.provenance = Image<uint8_t>(kWidth, kHeight, 2);
    WriteRefined(workspace, image, maps, {});
  }

  fs::path root_;
};

TEST_F(WorkspaceComparisonTest, FindsWhatWasRefined) {
  const Workspace workspace(root_, MapType::kGeometric);
  EXPECT_TRUE(FindRefinedImages(workspace).empty());
  Refine(workspace, 0);
  Refine(workspace, 2);
  EXPECT_EQ(FindRefinedImages(workspace), (std::vector<int>{0, 2}));
}

TEST_F(WorkspaceComparisonTest, ReadsBeforeAndAfter) {
  const Workspace workspace(root_, MapType::kGeometric);
  Refine(workspace, 1);
  const ComparisonRow row = ReadComparisonRow(workspace, 1);
  EXPECT_EQ(row.name, "1.png");
  ASSERT_EQ(row.image.Width(), kWidth);
  ASSERT_EQ(row.image.Height(), kHeight);
  EXPECT_EQ(row.image(3, 3).r, 7);
  EXPECT_EQ(row.image(3, 3).b, 9);
  EXPECT_EQ(row.before(3, 3), kOriginalDepth);
  EXPECT_EQ(row.after(3, 3), kRefinedDepth);
  EXPECT_EQ(row.normals_before(3, 3).z, -1.f);
  EXPECT_EQ(row.normals_after(3, 3).y, -1.f);
  EXPECT_EQ(row.provenance(3, 3), 2);
  EXPECT_GT(DrawComparison({row}).Height(), 0);
}

TEST_F(WorkspaceComparisonTest, RefusesMapsOfAnotherSizeThanBefore) {
  const Workspace workspace(root_, MapType::kGeometric);
  Refine(workspace, 1);
  const fs::path path = workspace.Paths(1, MapType::kGeometric).normal;
  WriteNormalMap(UserPath(path), Image<Vec3f>(kWidth / 2, kHeight / 2));
  try {
    ReadComparisonRow(workspace, 1);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.Code(), ErrorCode::kMismatch);
    EXPECT_EQ(std::string(error.what()).find(path.string()), 0u)
        << error.what();
  }
}

TEST(PickEvenly, SpreadsOverAllValues) {
  const std::vector<int> values = {10, 11, 12, 13, 14, 15, 16, 17};
  EXPECT_EQ(PickEvenly(values, 1), (std::vector<int>{10}));
  EXPECT_EQ(PickEvenly(values, 3), (std::vector<int>{10, 12, 15}));
  EXPECT_EQ(PickEvenly(values, 8), values);
  EXPECT_EQ(PickEvenly(values, 100), values);
  EXPECT_TRUE(PickEvenly(values, 0).empty());
  EXPECT_TRUE(PickEvenly({}, 3).empty());
}

}  // namespace
}  // namespace tsar
