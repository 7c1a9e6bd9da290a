// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/workspace_lock.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <sstream>

#include "tests/run/refine_workspace_fixture.h"
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

TEST_F(RefineWorkspaceTest, FillsTheBareWallAndKeepsTheOriginals) {
  const Tree before = ReadTree(root_);
  const RunSummary summary = Refine();
  EXPECT_EQ(summary.num_images, 4);
  EXPECT_EQ(summary.num_refined, 4);
  EXPECT_TRUE(summary.kept.empty());
  EXPECT_EQ(summary.counts.at("pixels"), 4 * 96 * 72);
  EXPECT_GT(summary.counts.at("depth_after"),
            summary.counts.at("depth_before"));

  for (int view = 0; view < 4; ++view) {
    const MapPaths paths = Paths(view);
    for (const auto& [stored, current] :
         {std::pair(paths.original_depth, paths.depth),
          std::pair(paths.original_normal, paths.normal)}) {
      EXPECT_TRUE(ReadText(stored) ==
                  before.at(current.Path().lexically_relative(root_)));
    }
    EXPECT_TRUE(std::filesystem::exists(paths.confidence));
    EXPECT_TRUE(std::filesystem::exists(paths.provenance));
    // Before, depths there were right only by chance.
    ExpectBareWallFilled(view);
  }
}

TEST_F(RefineWorkspaceTest, RestoreRemovesWhatARunLeftThatChangedNoMap) {
  const Tree before = ReadTree(root_);
  Observe(Options(root_));
  EXPECT_TRUE(HasEvidence());
  {
    const WorkspaceLock lock(root_);
    EXPECT_EQ(Restore(root_).num_restored, 0);
  }
  ExpectSameFiles(before, ReadTree(root_));
  ExpectError(
      ErrorCode::kNotFound, {"nothing to restore"}, [&] { Restore(root_); });
  // The lock is nothing to restore either.
  const WorkspaceLock lock(root_);
  ExpectError(
      ErrorCode::kNotFound, {"nothing to restore"}, [&] { Restore(root_); });
}

TEST_F(RefineWorkspaceTest, LeavesDoubtfulDepthsOut) {
  RefineOptions options;
  options.min_confidence = 0.6;
  EXPECT_EQ(Refine(Options(root_), options).num_refined, 4);
  size_t num_left = 0;
  for (int view = 0; view < 4; ++view) {
    const MapPaths paths = Paths(view);
    const Image<float> depth = ReadDepthMap(paths.depth);
    const Image<Vec3f> normal = ReadNormalMap(paths.normal);
    const Image<uint8_t> confidence = ReadGrayPng(paths.confidence);
    const Image<uint8_t> provenance = ReadGrayPng(paths.provenance);
    const Image<uint16_t> planes = ReadGray16Png(paths.planes);
    for (size_t i = 0; i < depth.NumPixels(); ++i) {
      const bool is_left = confidence.Data()[i] > 0;
      num_left += is_left ? 1 : 0;
      ASSERT_TRUE(!is_left || confidence.Data()[i] >= 153);
      ASSERT_EQ(depth.Data()[i] > 0.f, is_left);
      ASSERT_EQ(normal.Data()[i] == Vec3f{}, !is_left);
      ASSERT_EQ(provenance.Data()[i] != 0, is_left);
      ASSERT_TRUE(is_left || planes.Data()[i] == 0);
    }
  }
  EXPECT_GT(num_left, 1000u);
  // No depth is certain: an empty map replaces the measured depths, all of
  // which are doubtful.
  options.min_confidence = 1.0;
  const RunSummary summary = Refine(Options(root_), options);
  EXPECT_EQ(summary.num_refined, 4);
  EXPECT_TRUE(summary.kept.empty());
  const Image<float> depth = ReadDepthMap(Paths(0).depth);
  EXPECT_TRUE(std::all_of(
      depth.begin(), depth.end(), [](float z) { return z == 0.f; }));
}

TEST_F(RefineWorkspaceTest, SkipsWhatIsDoneAndRedoesWithOtherOptions) {
  RefineOptions others;
  others.segment = false;
  others.confirmed_depths = false;
  Refine(Options(root_), others);
  const Tree with_others = MapsOf(root_);
  Refine();
  const Tree refined = MapsOf(root_);
  EXPECT_FALSE(refined == with_others);

  const RunSummary again = Refine();
  EXPECT_EQ(again.num_skipped, 4);
  EXPECT_EQ(again.num_refined, 0);
  ExpectSameFiles(refined, MapsOf(root_));

  // The originals are refined again, not the refined maps.
  EXPECT_EQ(Refine(Options(root_), others).num_refined, 4);
  ExpectSameFiles(with_others, MapsOf(root_));
}

TEST_F(RefineWorkspaceTest, ThreadsAndMemoryDoNotChangeAByte) {
  WorkspaceRefineOptions options = Options(root_);
  options.output_path = folder_.Path() / "out1";
  const Tree before = ReadTree(root_);
  const RunSummary summary = Refine(options);
  EXPECT_EQ(summary.num_workers, 1);
  EXPECT_EQ(summary.workspace_path, options.output_path);
  ExpectSameFiles(before, ReadTree(root_));
  const Tree expected = MapsOf(options.output_path);
  for (const int num_threads : {2, 7}) {
    options.devices.num_threads = num_threads;
    options.output_path =
        folder_.Path() / ("out" + std::to_string(num_threads));
    EXPECT_EQ(Refine(options).num_workers, std::min(num_threads, 4));
    ExpectSameFiles(expected, MapsOf(options.output_path));
  }
  options.devices.cache_size = 1e-4;
  options.output_path = folder_.Path() / "out_small";
  EXPECT_EQ(Refine(options).num_workers, 1);
  ExpectSameFiles(expected, MapsOf(options.output_path));
  // In place, where the originals of some are read while others are written.
  options = Options(root_);
  options.devices.num_threads = 4;
  Refine(options);
  ExpectSameFiles(expected, MapsOf(root_));
}

// The share of the pixels of all images whose depth in `scaled` is `scale`
// times that in `root` and whose provenance is the same.
double ShareOfScaledPixels(const std::filesystem::path& root,
                           const std::filesystem::path& scaled,
                           double scale,
                           double tolerance) {
  int64_t num_pixels = 0;
  int64_t num_same = 0;
  for (const std::string& name : SyntheticWorkspace::Names()) {
    const MapPaths a = GetMapPaths(root, name, MapType::kGeometric);
    const MapPaths b = GetMapPaths(scaled, name, MapType::kGeometric);
    const Image<float> depth_a = ReadDepthMap(a.depth);
    const Image<float> depth_b = ReadDepthMap(b.depth);
    const cv::Mat provenance_a =
        cv::imread(a.provenance.string(), cv::IMREAD_UNCHANGED);
    const cv::Mat provenance_b =
        cv::imread(b.provenance.string(), cv::IMREAD_UNCHANGED);
    for (int y = 0; y < depth_a.Height(); ++y) {
      for (int x = 0; x < depth_a.Width(); ++x) {
        const double expected = depth_a(x, y) * scale;
        const bool is_same =
            std::abs(depth_b(x, y) - expected) <= tolerance * expected &&
            provenance_a.at<uchar>(y, x) == provenance_b.at<uchar>(y, x);
        ++num_pixels;
        num_same += is_same ? 1 : 0;
      }
    }
  }
  return static_cast<double>(num_same) / static_cast<double>(num_pixels);
}

TEST_F(RefineWorkspaceTest, GivesOpenCvItsThreadsBack) {
  const int num_threads_before = cv::getNumThreads();
  cv::setNumThreads(2);
  std::atomic<int> num_threads_meanwhile = 0;
  Refine(Options(root_), {}, [&] {
    num_threads_meanwhile = cv::getNumThreads();
    return false;
  });
  EXPECT_EQ(num_threads_meanwhile, 1);
  EXPECT_EQ(cv::getNumThreads(), 2);
  std::filesystem::remove_all(root_);
  EXPECT_THROW(Refine(), Error);
  EXPECT_EQ(cv::getNumThreads(), 2);
  cv::setNumThreads(num_threads_before);
}

TEST_F(RefineWorkspaceTest, ScalingTheSceneScalesTheDepthsAndNothingElse) {
  Refine();
  struct Case {
    double scale;
    double tolerance;
    double min_share;
  };
  // Powers of two change no mantissa. Others are rounded, which may decide
  // whether a superpixel gets a plane; each is more than 1 % of an image.
  for (const Case& c : {Case{1024.0, 0.0, 1.0},
                        Case{1.0 / 1024.0, 0.0, 1.0},
                        Case{1000.0, 1e-3, 0.95},
                        Case{0.001, 1e-3, 0.95}}) {
    const std::filesystem::path scaled = folder_.Path() / "scaled";
    std::filesystem::remove_all(scaled);
    MakeSyntheticWorkspace(scaled, c.scale);
    Refine(Options(scaled));
    EXPECT_GE(ShareOfScaledPixels(root_, scaled, c.scale, c.tolerance),
              c.min_share)
        << c.scale;
  }
}

TEST_F(RefineWorkspaceTest, KeepsImagesThatCannotBeRefined) {
  // v1 has no maps, v2 sees only v1, and v3 has no depth.
  RemoveMaps(1, MapType::kGeometric);
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\n__all__\nv1.png\nv0.png\nleft/v2.png\nv1.png\n"
            "v3.png\nv0.png\n");
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    WriteDepthMap(UserPath(Paths(3, type).depth), Image<float>(96, 72, 0.f));
  }
  const std::string before = ReadText(Paths(3).depth);
  const RunSummary summary = Refine(Options(root_), RefineOptions());
  EXPECT_EQ(summary.num_refined, 1);
  EXPECT_EQ(summary.num_sources_without_maps, 1);
  ASSERT_EQ(summary.kept.size(), 3u);
  EXPECT_EQ(summary.kept[0].name, "v1.png");
  EXPECT_THAT(summary.kept[0].reason, testing::HasSubstr("no geometric maps"));
  EXPECT_EQ(summary.kept[1].name, "left/v2.png");
  EXPECT_THAT(summary.kept[1].reason, testing::HasSubstr("source images"));
  EXPECT_EQ(summary.kept[2].name, "v3.png");
  EXPECT_THAT(summary.kept[2].reason, testing::HasSubstr("no valid depth"));
  EXPECT_TRUE(ReadText(Paths(3).depth) == before);
  EXPECT_EQ(Manifest()["num_images"]["kept"], 3);

  std::ostringstream text;
  PrintSummary(summary, text);
  PrintNext(summary, text);
  EXPECT_THAT(text.str(), testing::HasSubstr("4 images: 1 refined, 3 kept"));
  EXPECT_THAT(text.str(), testing::HasSubstr("left/v2.png: none of"));
  EXPECT_THAT(text.str(), testing::HasSubstr("colmap stereo_fusion"));
}

TEST_F(RefineWorkspaceTest, CountsValuesThatAreNotFinite) {
  std::string bytes = ReadText(Paths(0).depth);
  for (const float value : {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity()}) {
    bytes.resize(bytes.size() - sizeof(float));
    std::string text;
    Append(value, &text);
    bytes.insert(std::string("96&72&1&").size(), text);
  }
  WriteText(Paths(0).depth, bytes);
  const RunSummary summary = Refine();
  EXPECT_EQ(summary.counts.at("not_finite"), 2);
  for (const float depth : ReadDepthMap(Paths(0).depth)) {
    ASSERT_TRUE(std::isfinite(depth));
  }
}

TEST_F(RefineWorkspaceTest, MapsOfOtherConventionsAreReadAsColmapsAre) {
  const Tree expected = RefinedInOneGo(
      {}, [](const auto& root) { WriteOtherConventions(root, 0.f); });
  WriteOtherConventions(root_, 1e6f);
  EXPECT_THAT(
      WarningsOf(Options(root_), 4),
      testing::AllOf(
          testing::HasSubstr(
              "v0.png, geometric maps and 3 more: the normals point away"),
          testing::HasSubstr(
              "v0.png, geometric maps and 3 more: many depths are 1e+06")));
  for (const auto& [name, content] : MapsOf(root_)) {
    EXPECT_TRUE(name.ends_with(".photometric.bin") ||
                content == expected.at(name))
        << name;
  }
}

TEST_F(RefineWorkspaceTest, TakesPhotometricMapsWhereThereAreNoOthers) {
  for (int view = 0; view < 4; ++view) {
    RemoveMaps(view, MapType::kGeometric);
  }
  EXPECT_EQ(Refine().type, MapType::kPhotometric);
  EXPECT_TRUE(
      std::filesystem::exists(Paths(0, MapType::kPhotometric).original_depth));
  // Not if the user has chosen a type.
  WorkspaceRefineOptions options = Options(root_);
  options.input_type = MapType::kGeometric;
  ExpectError(ErrorCode::kNotFound,
              {"depth_maps", "no geometric map", "input_type"},
              [&] { Refine(options); });
}

TEST_F(RefineWorkspaceTest, TheManifestTellsWhatTheRunWasDoneWith) {
  WorkspaceRefineOptions options = Options(root_);
  options.devices.cache_size = 2.5;
  Refine(options);
  const nlohmann::json runtime = Manifest()["runtime"];
  EXPECT_EQ(runtime["device"], "cpu");
  EXPECT_EQ(runtime["gpu_index"], "-1");
  EXPECT_EQ(runtime["num_threads"], "1");
  EXPECT_EQ(runtime["cache_size"], "2.5");
  EXPECT_EQ(runtime["used"], "1 CPU thread");
  EXPECT_FALSE(Manifest()["options"].contains("device"));
  // No result depends on it, so nothing is done again.
  options.devices.num_threads = 2;
  options.devices.cache_size = 3.0;
  EXPECT_EQ(Refine(options).num_skipped, 4);
  EXPECT_EQ(Manifest()["runtime"]["num_threads"], "2");
}

}  // namespace
}  // namespace tsar
