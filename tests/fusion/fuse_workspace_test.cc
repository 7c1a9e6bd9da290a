// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fuse_workspace.h"

#include "colmap_tsar/fusion/fusion_neighbors.h"
#include "colmap_tsar/io/ply.h"
#include "colmap_tsar/run/store/write_back.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <sstream>

#include "tests/support/mask_files.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

namespace fs = std::filesystem;
using Wall = SyntheticWorkspace;

class FuseWorkspaceTest : public testing::Test {
 protected:
  void SetUp() override {
    MakeSyntheticWorkspace(root_);
    options_.output_path = output_;
    options_.devices.choice = DeviceChoice::kCpu;
  }

  FuseSummary Fuse(const std::function<bool()>& should_stop = nullptr) {
    std::ostringstream out;
    Progress progress(out, false);
    progress.SetStop(should_stop);
    return FuseWorkspace(
        Workspace(root_, MapType::kGeometric), options_, progress);
  }

  std::string Bytes() const {
    return ReadText(output_) + ReadText(output_.string() + ".vis");
  }

  const TemporaryFolder folder_;
  const fs::path root_ = folder_.Path() / "dense";
  const TemporaryFolder output_folder_;
  const fs::path output_ = output_folder_.Path() / "fused.ply";
  FuseWorkspaceOptions options_;
};

TEST_F(FuseWorkspaceTest, TheWallIsThereOnceAndInItsPlace) {
  options_.fusion.point_spacing = 1;
  const FuseSummary summary = Fuse();
  EXPECT_EQ(summary.num_images, 4);
  EXPECT_THAT(summary.devices, testing::HasSubstr("CPU threads"));
  const std::vector<Eigen::Vector3d> points = ReadPlyPoints(output_);
  ASSERT_EQ(static_cast<int64_t>(points.size()), summary.num_points);
  // Not once for each image.
  EXPECT_GT(points.size(), size_t{Wall::kWidth} * Wall::kHeight / 2);
  EXPECT_LT(points.size(), size_t{2} * Wall::kWidth * Wall::kHeight);
  // A few of the wrong depths in the textureless rectangle agree by chance.
  const auto num_right = std::count_if(
      points.begin(), points.end(), [](const Eigen::Vector3d& point) {
        return std::abs(point.z() - Wall::kDepth) < 0.02 * Wall::kDepth;
      });
  EXPECT_GT(num_right, 0.99 * static_cast<double>(points.size()));
}

TEST_F(FuseWorkspaceTest, ThreadsAndMemoryDoNotChangeAByte) {
  Fuse();
  const std::string bytes = Bytes();
  options_.devices.num_threads = 1;
  options_.devices.cache_size = 1e-4;  // One image at a time.
  Fuse();
  EXPECT_EQ(Bytes(), bytes);
  options_.devices.num_threads = 5;
  options_.devices.cache_size = 1.0;
  Fuse();
  EXPECT_EQ(Bytes(), bytes);
}

TEST_F(FuseWorkspaceTest, PointsComeFromListedImagesAlone) {
  options_.fusion.point_spacing = 1;
  const fs::path list = folder_.Path() / "list.txt";
  WriteText(list, "v3.png\n");
  options_.image_list_path = list;
  const FuseSummary summary = Fuse();
  EXPECT_EQ(summary.num_images, 1);
  // The others, which confirm its points, add none.
  EXPECT_GT(summary.num_points, Wall::kWidth * Wall::kHeight / 2);
  const std::string visibility = ReadText(output_.string() + ".vis");
  EXPECT_GT(visibility.size(),
            8 + 3 * 4 * static_cast<size_t>(summary.num_points));
}

TEST_F(FuseWorkspaceTest, ImagesThatTheConfigurationLeavesOutAreNotUsed) {
  options_.fusion.point_spacing = 1;
  WriteText(root_ / "stereo/fusion.cfg", "v0.png\nv3.png\n");
  EXPECT_EQ(Fuse().num_images, 2);
  WriteText(root_ / "stereo/fusion.cfg", "v0.png\n");
  EXPECT_EQ(Fuse().num_points, 0);  // No other view agrees with it.
}

TEST_F(FuseWorkspaceTest, MaskedDepthsAreMissing) {
  const fs::path masks = folder_.Path() / "masks";
  for (const std::string& name : Wall::Names()) {
    WriteMask(
        masks / (name + ".png"), Wall::kWidth, Wall::kHeight, [](int, int y) {
          return y < Wall::kHeight / 2;
        });
  }
  options_.mask_path = masks;
  const FuseSummary summary = Fuse();
  EXPECT_EQ(summary.num_masks, 4);
  const std::vector<Eigen::Vector3d> points = ReadPlyPoints(output_);
  ASSERT_FALSE(points.empty());
  for (const Eigen::Vector3d& point : points) {
    EXPECT_GT(point.y(), -0.1);  // The lower half of the wall: y is down.
  }
}

TEST_F(FuseWorkspaceTest, MapsOfOtherConventionsAreReadAsColmapsAre) {
  WriteOtherConventions(root_, 0.f);
  Fuse();
  const std::string expected = Bytes();
  WriteOtherConventions(root_, 1e6f);
  testing::internal::CaptureStderr();
  Fuse();
  EXPECT_THAT(
      testing::internal::GetCapturedStderr(),
      testing::AllOf(
          testing::HasSubstr("v1.png and 3 more: many depths are 1e+06"),
          testing::HasSubstr("v1.png and 3 more: the normals point")));
  EXPECT_EQ(Bytes(), expected);
}

TEST_F(FuseWorkspaceTest, WithBadMapsOrNoneNothingIsWritten) {
  const fs::path map = root_ / "stereo/depth_maps/v3.png.geometric.bin";
  fs::resize_file(map, fs::file_size(map) - 1);
  // All images at once, and one after the other.
  for (const double cache_size : {options_.devices.cache_size, 1e-6}) {
    options_.devices.cache_size = cache_size;
    ExpectError(ErrorCode::kCorrupt, {map.string()}, [&] { Fuse(); });
  }
  fs::remove_all(root_ / "stereo/depth_maps");
  fs::create_directories(root_ / "stereo/depth_maps");
  ExpectError(ErrorCode::kNotFound,
              {root_.string(), "no image to fuse has geometric depth"},
              [&] { Fuse(); });
  EXPECT_TRUE(fs::is_empty(output_.parent_path()));
}

TEST_F(FuseWorkspaceTest, AnInterruptedRunLeavesTheFormerCloud) {
  WriteText(output_, "former");
  std::atomic<int> num_questions = 0;
  ExpectError(ErrorCode::kInterrupted, {"nothing was written"}, [&] {
    Fuse([&] { return ++num_questions > 5; });
  });
  EXPECT_EQ(ReadText(output_), "former");
}

TEST(ReadBoundingBoxTest, NeedsSixNumbersOfABox) {
  const TemporaryFolder folder;
  const fs::path path = folder.Path() / "box.txt";
  WriteText(path, "-1 -2 -3\n4 5 6.5\n");
  const Eigen::AlignedBox3d box = ReadBoundingBox(path);
  EXPECT_EQ(box.min(), Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ(box.max(), Eigen::Vector3d(4, 5, 6.5));
  WriteText(path, "\xEF\xBB\xBF# hall\r\n-1 -2 -3 # low\r\n4 5 6.5\r\n");
  EXPECT_EQ(ReadBoundingBox(path).min(), box.min());
  EXPECT_EQ(ReadBoundingBox(path).max(), box.max());
  for (const char* bad : {"",
                          "0 0 0 1 1 # 1",
                          "1 2 3 4 5",
                          "1 2 3 4 5 x",
                          "1 0 0 0 1 1",
                          "nan 0 0 1 1 1",
                          "0 0 0 1 1 1 1",
                          "0 0 0 1 1 100abc",
                          "0 0 0 1 1 1 x"}) {
    WriteText(path, bad);
    ExpectError(ErrorCode::kCorrupt, {path.string(), "six numbers"}, [&] {
      ReadBoundingBox(path);
    });
  }
  ExpectError(ErrorCode::kNotFound, {"none.txt"}, [&] {
    ReadBoundingBox(folder.Path() / "none.txt");
  });
}

TEST(PlanFusionTest, NoMoreSourcesAreTakenThanAskedFor) {
  const TemporaryFolder folder;
  const fs::path root = folder.Path() / "dense";
  MakeSyntheticWorkspace(root);
  const Workspace workspace(root, MapType::kGeometric);
  const fs::path list = folder.Path() / "list.txt";
  const std::vector<std::string>& names = Wall::Names();
  WriteText(list, names[0] + "\n" + names[2] + "\n" + names[3] + "\n");
  const FusionPlan plan = PlanFusion(workspace, list, 2);
  EXPECT_EQ(plan.order.size(), 3u);
  EXPECT_EQ(plan.places[1], -1);
  for (const std::vector<int>& sources : plan.sources) {
    EXPECT_EQ(sources.size(), 2u);
  }
}

}  // namespace
}  // namespace tsar
