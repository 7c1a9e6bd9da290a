// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

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
