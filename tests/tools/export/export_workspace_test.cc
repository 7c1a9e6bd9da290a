// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/export/export_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/export/map_levels.h"

#include <filesystem>
#include <sstream>

#include "tests/support/synthetic_workspace.h"
#include "tests/support/write_refined.h"
#include "tests/tools/export/export_fixture.h"

namespace tsar {
namespace {

namespace fs = std::filesystem;
using ExportWorkspaceTest = ExportTest;

TEST_F(ExportWorkspaceTest, WritesAFolderWithAManifest) {
  const auto before = ReadTree(root_);
  const ExportSummary summary = Export(ExportFormat::kNpy);
  EXPECT_EQ(summary.num_images, 2);
  EXPECT_EQ(summary.num_with_depth, 2);
  EXPECT_EQ(summary.num_pixels, 24);
  EXPECT_EQ(summary.num_depths, 22);
  const nlohmann::json manifest = ReadJson("manifest.json");
  EXPECT_EQ(manifest["format"], "tsar_export");
  EXPECT_EQ(manifest["export_format"], "npy");
  EXPECT_EQ(manifest["map_type"], "geometric");
  EXPECT_EQ(manifest["images_left_out"], nlohmann::json({"c.png"}));
  EXPECT_TRUE(ImageEntry("a.1.png")["refined"]);
  EXPECT_FALSE(ImageEntry("left/b.png")["refined"]);
  EXPECT_EQ(ImageEntry("left/b.png")["camera"]["width"], kWidth);
  EXPECT_EQ(ImageEntry("left/b.png")["camera"]["cy"], kCy / 2.0);
  // All files, and nothing beside the folder; the lock came with reading.
  std::istringstream list(ReadText(options_.output_path / "files.txt"));
  std::string name;
  int num_files = 0;
  while (std::getline(list, name)) {
    EXPECT_TRUE(fs::is_regular_file(options_.output_path / name)) << name;
    ++num_files;
  }
  EXPECT_EQ(num_files, 6 + 2 + 2);
  auto after = ReadTree(root_);
  after.erase("stereo/tsar/lock");
  auto expected = before;
  expected.erase("stereo/tsar/lock");
  EXPECT_TRUE(after == expected);
}

TEST_F(ExportWorkspaceTest, ReplacesAnExportOnlyWhenAsked) {
  Export(ExportFormat::kNpy);
  ExpectFailure(ErrorCode::kUnsupported,
                {"holds an export already", "overwrite"});
  options_.overwrite = true;
  Export(ExportFormat::kPng16);
  EXPECT_FALSE(fs::exists(options_.output_path / "depth/a.1.png.npy"));
  EXPECT_TRUE(fs::exists(options_.output_path / "depth/a.1.png.png"));
  WriteText(options_.output_path / "depth/mine.txt", "years of work");
  ExpectFailure(ErrorCode::kUnsupported, {"mine.txt", "not of the export"});
  fs::remove_all(options_.output_path);
  WriteText(options_.output_path / "mine.txt", "years of work");
  ExpectFailure(ErrorCode::kUnsupported, {"is no export", "output_path"});
  options_.output_path = root_ / "stereo" / "new";
  ExpectFailure(ErrorCode::kUnsupported, {"stereo"});
}

TEST_F(ExportWorkspaceTest, TakesTheMapsThatAreThere) {
  const auto type = [&] {
    return OpenWorkspaceWithMaps(root_, std::nullopt).Type();
  };
  EXPECT_EQ(type(), MapType::kGeometric);
  for (const char* kind : {"depth_maps", "normal_maps"}) {
    const fs::path folder = root_ / "stereo" / kind;
    fs::rename(folder / "left/b.png.geometric.bin",
               folder / "left/b.png.photometric.bin");
    fs::remove(folder / "a.1.png.geometric.bin");
  }
  fs::remove(root_ / "stereo/provenance_maps/a.1.png.geometric.png");
  EXPECT_EQ(type(), MapType::kPhotometric);
  EXPECT_EQ(Export(ExportFormat::kNpy).num_images, 1);
  const Workspace geometric = OpenWorkspaceWithMaps(root_, MapType::kGeometric);
  std::ostringstream out;
  Progress progress(out, false);
  options_.output_path = folder_.Path() / "other";
  ExpectError(
      ErrorCode::kNotFound, {"no image has geometric", "tsar_stereo"}, [&] {
        ExportWorkspace(geometric, options_, progress, [] { return false; });
      });
  EXPECT_FALSE(fs::exists(options_.output_path));
}

// Refined maps come first, whatever their type.
TEST_F(ExportWorkspaceTest, PrefersRefinedMaps) {
  fs::remove(root_ / "stereo/provenance_maps/a.1.png.geometric.png");
  WriteTestMaps(root_, "left/b.png", MapType::kPhotometric, 3.f);
  EXPECT_EQ(OpenWorkspaceWithMaps(root_, std::nullopt).Type(),
            MapType::kGeometric);
  WriteRefined(
      Workspace(root_, MapType::kPhotometric), 1, MakeRefinedMaps(9.f), {});
  EXPECT_EQ(OpenWorkspaceWithMaps(root_, std::nullopt).Type(),
            MapType::kPhotometric);
}

TEST_F(ExportWorkspaceTest, LeavesNothingWhereItFails) {
  // A map of another size than its depth map, one that breaks off.
  WriteText(root_ / "stereo/sigma_maps/a.1.png.geometric.npy", "half");
  ExpectFailure(ErrorCode::kCorrupt, {"a.1.png.geometric.npy"});
  fs::remove(root_ / "stereo/sigma_maps/a.1.png.geometric.npy");
  options_.format = ExportFormat::kExr;
  options_.depth_scale = 0.01;
  ExpectFailure(ErrorCode::kBadOption, {"depth_scale", "png16"});
  options_.depth_scale = ExportOptions::kDefaultDepthScale;
  options_.format = ExportFormat::kNpy;
  const auto before = ReadTree(folder_.Path());
  std::ostringstream out;
  Progress progress(out, false);
  int num_asked = 0;
  options_.num_threads = 1;
  ExpectError(ErrorCode::kInterrupted, {"nothing was exported"}, [&] {
    ExportWorkspace(
        OpenWorkspaceWithMaps(root_, std::nullopt), options_, progress, [&] {
          return ++num_asked == 2;
        });
  });
  EXPECT_EQ(num_asked, 2);
  EXPECT_TRUE(ReadTree(folder_.Path()) == before);
  const WorkspaceLock lock(root_);
  ExpectFailure(ErrorCode::kUnsupported, {"lock"});
}

TEST(MapLevelsTest, KeepsZeroForNoDepth) {
  Image<float> values(5, 1);
  values(1, 0) = 0.0004f;  // Less than half a step.
  values(2, 0) = 0.0006f;
  values(3, 0) = 65.5353f;
  values(4, 0) = 65.5357f;
  int64_t num_out_of_range = 0;
  const Image<uint16_t> depth = DepthLevels(values, 0.001, &num_out_of_range);
  EXPECT_EQ(std::vector<int>(depth.begin(), depth.end()),
            (std::vector<int>{0, 0, 1, 65535, 0}));
  EXPECT_EQ(num_out_of_range, 2);
  const Image<uint16_t> sigma = SigmaLevels(values, 0.001);
  EXPECT_EQ(std::vector<int>(sigma.begin(), sigma.end()),
            (std::vector<int>{0, 1, 1, 65535, 65535}));
  EXPECT_DOUBLE_EQ(StepFor(65.535), 0.001);
  EXPECT_DOUBLE_EQ(StepFor(66.0), 0.002);
  EXPECT_DOUBLE_EQ(StepFor(3000.0), 0.05);
}

TEST(DepthStatisticsTest, AreOfThePixelsWithADepth) {
  Image<float> depth(4, 1);
  EXPECT_EQ(MeasureDepth(depth).num_depths, 0);
  depth(1, 0) = 5.f;
  depth(2, 0) = 2.f;
  depth(3, 0) = 3.f;
  const DepthStatistics map = MeasureDepth(depth);
  EXPECT_EQ(map.num_depths, 3);
  EXPECT_EQ(map.nearest, 2.f);
  EXPECT_EQ(map.farthest, 5.f);
  EXPECT_EQ(map.median, 3.f);
  const DepthStatistics all =
      JoinStatistics({{}, map, {7, 1.f, 4.f, 2.f}, {1, 9.f, 9.f, 9.f}});
  EXPECT_EQ(all.num_depths, 11);
  EXPECT_EQ(all.nearest, 1.f);
  EXPECT_EQ(all.farthest, 9.f);
  EXPECT_EQ(all.median, 3.f);
}

}  // namespace
}  // namespace tsar
