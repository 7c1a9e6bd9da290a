// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/shard_record.h"

#include <chrono>

#include "tests/run/refine_shard_fixture.h"

namespace tsar {
namespace {

TEST_F(RefineShardTest, ChangesAfterObservingAreSeen) {
  RunAll("observe", 2);
  for (int view = 0; view < 4; ++view) {
    Run("model");
    const auto time = std::filesystem::last_write_time(Paths(view).depth);
    std::filesystem::last_write_time(Paths(view).depth,
                                     time + std::chrono::seconds(2));
    int num_refusals = 0;
    for (const char* shard : {"0/2", "1/2"}) {
      const Tree before = ReadTree(root_ / "stereo/depth_maps");
      try {
        Run("compose", shard);
      } catch (const Error& error) {
        ++num_refusals;
        EXPECT_TRUE(error.Code() == ErrorCode::kMismatch);
        EXPECT_THAT(error.what(),
                    testing::HasSubstr("observe of all shards again"));
        EXPECT_TRUE(ReadTree(root_ / "stereo/depth_maps") == before);
      }
    }
    EXPECT_EQ(num_refusals, 2) << view;
    Restore(root_);
    RunAll("observe", 2);
  }
}

// What the first has seen of an image is not what the second sees.
TEST_F(RefineShardTest, ChangesWhileShardsObserveAreSeen) {
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    for (int view = 0; view < 4; ++view) {
      Redraw();
      Run("observe", "0/2", refine);
      const std::filesystem::path photo =
          root_ / "images" / SyntheticWorkspace::Names()[view];
      std::filesystem::last_write_time(
          photo,
          std::filesystem::last_write_time(photo) + std::chrono::seconds(2));
      Run("observe", "1/2", refine);
      int num_refusals = 0;
      for (const char* shard : {"0/2", "1/2"}) {
        const Tree before = ReadTree(root_ / "stereo/depth_maps");
        try {
          Run("compose", shard, refine);
        } catch (const Error& error) {
          ++num_refusals;
          EXPECT_TRUE(error.Code() == ErrorCode::kMismatch);
          EXPECT_THAT(error.what(),
                      testing::HasSubstr("observe of all shards again"));
          EXPECT_TRUE(ReadTree(root_ / "stereo/depth_maps") == before);
        }
      }
      EXPECT_EQ(num_refusals, 2) << view;
      RunAll("observe", 2, refine);
      RunAll("compose", 2, refine);
      Run("merge", "", refine);
      EXPECT_TRUE(ResultOf(root_) == ResultOf(Whole(refine))) << view;
    }
  }
}

// Also if it is the former one again when its own shard looks at it.
TEST_F(RefineShardTest, AnotherCameraIsSeenWhateverItsShard) {
  RunAll("observe", 2);
  const std::filesystem::path path = root_ / "sparse/images.txt";
  const std::string images = ReadText(path);
  for (int view = 0; view < 4; ++view) {
    const std::string number = std::to_string(view + 1) + " 1 ";
    std::string changed = images;
    changed.replace(changed.find(number), number.size(), number + "1e-4 ");
    const size_t fourth = changed.find(" 0 0 0", changed.find("1e-4"));
    ASSERT_NE(fourth, std::string::npos);
    changed.erase(fourth, 2);
    WriteText(path, changed);
    for (const char* shard : {"0/2", "1/2"}) {
      ExpectError(ErrorCode::kMismatch,
                  {"inputs of the run have changed", "observe of all shards"},
                  [&] { Run("compose", shard); });
    }
  }
  WriteText(path, images);
  RunAll("compose", 2);
  Run("merge");
  EXPECT_TRUE(ResultOf(root_) == ResultOf(Whole()));
}

TEST_F(RefineShardTest, RecordsOfOtherListsOfImagesAreNamed) {
  RunAll("observe", 2);
  ShardRecord record = ReadShardRecord(GetShardPath(root_, "observe", 1, 2));
  record.images.pop_back();
  WriteShardRecord(root_, record);
  ExpectRefusal(ErrorCode::kMismatch,
                {"observe-1-of-2.json", "names 1 images, not 2"},
                "compose",
                "0/2");
}

// What is stored of maps that no shard works on may be older than these.
TEST_F(RefineShardTest, ReadsTheLatestMapsOfOtherTypesAndImages) {
  RefineOptions refine;
  refine.scene_planes = false;
  refine.filter = false;
  WorkspaceRefineOptions photometric = Options(root_);
  photometric.input_type = MapType::kPhotometric;
  Refine(photometric, refine);
  Refine(Options(root_), refine);
  const auto write_anew = [&](int view, MapType type) {
    const MapPaths paths =
        GetMapPaths(root_, SyntheticWorkspace::Names()[view], type);
    ASSERT_TRUE(std::filesystem::exists(paths.original_depth));
    WriteDepthMap(paths.depth, Image<float>(96, 72, 5.5f));
    WriteNormalMap(paths.normal,
                   Image<Vec3f>(96, 72, Vec3f{0.06f, 0.08f, -0.99499f}));
    for (const ContainedPath& path : {paths.depth, paths.normal}) {
      std::filesystem::last_write_time(
          path, std::filesystem::last_write_time(path) + std::chrono::hours(1));
    }
  };
  for (const bool is_other_type : {true, false}) {
    if (is_other_type) {
      write_anew(0, MapType::kPhotometric);
    } else {
      write_anew(3, MapType::kGeometric);
      WriteText(root_ / "stereo/patch-match.cfg",
                "v0.png\n__all__\nv1.png\n__all__\nleft/v2.png\n__all__\n");
    }
    const std::filesystem::path whole =
        folder_.Path() / (is_other_type ? "whole_type" : "whole_image");
    std::filesystem::copy(
        root_, whole, std::filesystem::copy_options::recursive);
    refine.segment = !is_other_type;
    Refine(Options(whole), refine);
    RunAll("observe", 3, refine);
    RunAll("compose", 3, refine);
    Run("merge", "", refine);
    EXPECT_TRUE(ResultOf(root_) == ResultOf(whole)) << is_other_type;
  }
}

TEST_F(RefineShardTest, LostAndForeignEvidenceIsSeen) {
  RunAll("observe", 2);
  const std::string own = ReadText(Evidence(0));
  // Every image needs that of all others.
  for (const char* shard : {"0/2", "1/2"}) {
    std::filesystem::remove(Evidence(0));
    ExpectError(ErrorCode::kMismatch, {Evidence(0).string(), "observe"}, [&] {
      Run("compose", shard);
    });
    WriteText(Evidence(0), ReadText(Evidence(1)).substr(0, 40));
    ExpectError(ErrorCode::kMismatch, {Evidence(0).string(), "observe"}, [&] {
      Run("compose", shard);
    });
    WriteText(Evidence(0), own);
  }
  RunAll("compose", 2);
  Run("merge");
  EXPECT_TRUE(ResultOf(root_) == ResultOf(Whole()));
}

TEST_F(RefineShardTest, WhatNobodyNeededIsAskedFor) {
  RunAll("observe", 2);
  RunAll("compose", 2);
  RunAll("observe", 2);  // Nothing is needed: all are done.
  std::filesystem::remove(Paths(2).provenance);
  int num_refusals = 0;
  for (const char* shard : {"0/2", "1/2"}) {
    try {
      Run("compose", shard);
    } catch (const Error& error) {
      ++num_refusals;
      EXPECT_THAT(error.what(), testing::HasSubstr("observe of all shards"));
    }
  }
  EXPECT_EQ(num_refusals, 1);
  RunAll("observe", 2);
  RunAll("compose", 2);
  Run("merge");
  EXPECT_TRUE(ResultOf(root_) == ResultOf(Whole()));
}

}  // namespace
}  // namespace tsar
