// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/restore.h"

#include <chrono>
#include <functional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/run/refine_shard_fixture.h"
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

TEST_F(RefineShardTest, AnyNumberOfShardsGivesTheBytesOfOneRun) {
  const std::filesystem::path whole = Whole();
  for (const int count : {1, 3, 7}) {
    Redraw();
    RunAll("observe", count);
    RunAll("compose", count);
    EXPECT_TRUE(std::filesystem::exists(Evidence(root_, 0)));
    const RunSummary summary = Run("merge");
    EXPECT_EQ(summary.num_images, 4);
    EXPECT_EQ(summary.num_refined, 4);
    EXPECT_EQ(summary.counts.at("pixels"), 4 * 96 * 72);
    EXPECT_TRUE(ResultOf(root_) == ResultOf(whole)) << count;
    EXPECT_EQ(ManifestOf(root_), ManifestOf(whole)) << count;
  }
}

TEST_F(RefineShardTest, ShardsSideBySideGiveTheSame) {
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    const std::filesystem::path whole = Whole(refine);
    Redraw();
    for (const char* pass : {"observe", "compose"}) {
      if (pass == std::string("compose")) {
        Run("model", "", refine);
      }
      {
        std::vector<std::jthread> shards;
        for (const char* shard : {"0/4", "1/4", "2/4", "3/4"}) {
          shards.emplace_back([&, pass, shard] {
            EXPECT_NO_THROW(Refine(Options(root_, pass, shard), refine));
          });
        }
      }
      // A shard must not write files that others are reading.
      for (int view = 0; view < 4; ++view) {
        EXPECT_EQ(std::filesystem::exists(Evidence(root_, view)), scene_planes);
        EXPECT_EQ(std::filesystem::exists(Paths(view).original_depth),
                  pass == std::string("compose"));
      }
    }
    Run("merge", "", refine);
    EXPECT_TRUE(ResultOf(root_) == ResultOf(whole));
  }
}

TEST_F(RefineShardTest, TellsWhatItDid) {
  const auto expect_told = [](const RunSummary& summary,
                              const std::vector<std::string>& texts) {
    std::ostringstream text;
    PrintSummary(summary, text);
    PrintNext(summary, text);
    for (const std::string& expected : texts) {
      EXPECT_THAT(text.str(), testing::HasSubstr(expected));
    }
  };
  const RunSummary observed = Run("observe", "0/2");
  EXPECT_EQ(observed.num_images, 2);
  EXPECT_EQ(observed.num_observed, 2);
  EXPECT_EQ(observed.num_refined, 0);
  EXPECT_EQ(Run("observe", "0/2").num_skipped, 2);
  expect_told(observed,
              {"Shard 0 of 2, 2 images: 2 obs", "--TsarRefine.pass model"});
  Run("observe", "1/2");
  expect_told(Run("model"),
              {"4 images: the planes of the scene have been found",
               "--TsarRefine.pass compose"});
  expect_told(Run("compose", "1/2"),
              {"Shard 1 of 2, 2 images: 2 ref", "--TsarRefine.pass merge"});
  EXPECT_EQ(Run("compose", "1/2").num_skipped, 2);
  Run("compose", "0/2");
  expect_told(Run("merge"), {"4 images: 4 refined\n", "colmap stereo_fusion"});
}

TEST_F(RefineShardTest, ThePassesComeInTheirOrder) {
  const std::string all = "observe of all shards";
  ExpectRefusal(
      ErrorCode::kNotFound, {"was not observed", all}, "compose", "0/3");
  ExpectRefusal(ErrorCode::kNotFound, {"4 of 4 images", "v0.png"}, "merge");
  Run("observe", "1/3");
  ExpectRefusal(
      ErrorCode::kNotFound, {"was not observed", all}, "compose", "1/3");
  ExpectRefusal(ErrorCode::kNotFound, {"was not observed", all}, "model");
  Run("observe", "0/3");
  Run("observe", "2/3");
  ExpectRefusal(ErrorCode::kNotFound,
                {"planes.bin", "pass model first"},
                "compose",
                "2/3");
  Run("model");
  // Once more, it has nothing to do.
  const Tree modeled = ReadTree(root_);
  Run("model");
  EXPECT_TRUE(ReadTree(root_) == modeled);
  Run("compose", "2/3");
  ExpectRefusal(
      ErrorCode::kNotFound, {"of 4 images", "compose of all"}, "merge");
  Run("compose", "0/3");
  Run("compose", "1/3");
  Run("merge");
  // A merge that was killed at its very end, or is run twice.
  const Tree merged = ReadTree(root_);
  EXPECT_EQ(Run("merge").num_refined, 4);
  EXPECT_TRUE(ReadTree(root_) == merged);
}

TEST_F(RefineShardTest, WhatWasObservedWithOtherOptionsDoesNotCount) {
  RunAll("observe", 2);
  RefineOptions others;
  others.segment = false;
  ExpectRefusal(ErrorCode::kNotFound,
                {"was not observed with these options"},
                Options(root_, "model"),
                others);
  // Another number of shards does no harm.
  Run("model");
  RunAll("compose", 3);
  ExpectRefusal(
      ErrorCode::kNotFound, {"4 of 4 images"}, Options(root_, "merge"), others);
  RunAll("observe", 3, others);
  RunAll("compose", 2, others);
  EXPECT_EQ(Run("merge", "", others).num_refined, 4);
  EXPECT_TRUE(ResultOf(root_) == ResultOf(Whole(others)));
}

TEST_F(RefineShardTest, AFailureEndsItsShardAlone) {
  RunAll("observe", 2);
  Run("model");
  // A folder has the map's temporary name.
  const std::filesystem::path temporary =
      Paths(3).confidence.string() + AtomicFile::kTemporarySuffix;
  std::filesystem::create_directories(temporary / "in_the_way");
  int num_failures = 0;
  for (const char* shard : {"0/2", "1/2"}) {
    try {
      Run("compose", shard);
    } catch (const Error& error) {
      ++num_failures;
      EXPECT_THAT(error.what(), testing::HasSubstr("confidence_maps"));
    }
  }
  EXPECT_EQ(num_failures, 1);
  ExpectRefusal(ErrorCode::kNotFound, {"1 of 4 images", "v3.png"}, "merge");
  std::filesystem::remove_all(temporary);
  RunAll("compose", 2);
  Run("merge");
  EXPECT_TRUE(ResultOf(root_) == ResultOf(Whole()));
}

// Changes a file's time, as a program that rewrites it does.
void Touch(const std::filesystem::path& path) {
  std::filesystem::last_write_time(
      path, std::filesystem::last_write_time(path) + std::chrono::seconds(2));
}

TEST_F(RefineShardTest, ChangesAfterObservingAreSeen) {
  const std::function<void()> changes[] = {
      [&] { Touch(Paths(0).depth); },
      [&] { Touch(root_ / "images" / SyntheticWorkspace::Names()[3]); },
      [&] { std::filesystem::remove(Evidence(root_, 1)); },
      [&] {
        WriteText(Evidence(root_, 2),
                  ReadText(Evidence(root_, 1)).substr(0, 40));
      }};
  for (size_t i = 0; i < std::size(changes); ++i) {
    SCOPED_TRACE(i);
    Redraw();
    RunAll("observe", 2);
    Run("model");
    changes[i]();
    // Every image needs what was observed in all others.
    for (const char* shard : {"0/2", "1/2"}) {
      ExpectRefusal(ErrorCode::kNotFound,
                    {".bin: ", "was not observed", "observe of all shards"},
                    "compose",
                    shard);
    }
    RunAll("observe", 2);
    RunAll("compose", 2);
    Run("merge");
    EXPECT_TRUE(ResultOf(root_) == ResultOf(Whole()));
  }
}

TEST_F(RefineShardTest, WhatNobodyNeededIsAskedFor) {
  RunAll("observe", 2);
  RunAll("compose", 2);
  Run("merge");
  RunAll("observe", 2);  // Nothing is needed: all are done.
  std::filesystem::remove(Paths(2).provenance);
  ExpectRefusal(ErrorCode::kNotFound, {"left/v2.png"}, "merge");
  RunAll("observe", 2);
  RunAll("compose", 2);
  Run("merge");
  EXPECT_TRUE(ResultOf(root_) == ResultOf(Whole()));
}

TEST_F(RefineShardTest, RefusesOptionsThatContradictEachOther) {
  ExpectRefusal(ErrorCode::kBadOption, {"shard", "observe"}, "all", "0/2");
  ExpectRefusal(ErrorCode::kBadOption, {"shard"}, "merge", "0/2");
  ExpectRefusal(ErrorCode::kBadOption, {"shard", "model"}, "model", "0/2");
  WorkspaceRefineOptions options = Options(root_, "observe", "0/2");
  options.output_path = folder_.Path() / "out";
  ExpectRefusal(ErrorCode::kBadOption, {"output_path", "cp -as"}, options);
  // The only shard has all images.
  EXPECT_EQ(Run("all", "0/1").num_refined, 4);
}

TEST_F(RefineShardTest, WholeRunsTakeOverWhatShardsLeft) {
  const std::filesystem::path whole = Whole();
  RunAll("observe", 3);
  Run("model");
  Run("compose", "1/3");
  EXPECT_GT(Run("all").num_skipped, 0);
  EXPECT_TRUE(ResultOf(root_) == ResultOf(whole));
}

TEST_F(RefineShardTest, KeepsImagesThatCannotBeRefined) {
  const auto change = [](const std::filesystem::path& root) {
    const auto paths = [&](const char* name) {
      return GetMapPaths(root, name, MapType::kGeometric);
    };
    std::filesystem::remove(paths("v1.png").depth);
    std::filesystem::remove(paths("v1.png").normal);
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      WriteDepthMap(UserPath(GetMapPaths(root, "v3.png", type).depth),
                    Image<float>(96, 72, 0.f));
    }
  };
  for (const bool scene_planes : {true, false}) {
    RefineOptions refine;
    refine.scene_planes = scene_planes;
    Redraw();
    change(root_);
    RunAll("observe", 4, refine);
    RunAll("compose", 4, refine);
    const RunSummary summary = Run("merge", "", refine);
    EXPECT_EQ(summary.num_refined, 2);
    ASSERT_EQ(summary.kept.size(), 2u);
    EXPECT_EQ(summary.kept[0].name, "v1.png");
    EXPECT_EQ(summary.kept[1].name, "v3.png");
    const std::filesystem::path whole = Whole(refine, change);
    EXPECT_TRUE(ResultOf(root_) == ResultOf(whole));
    EXPECT_EQ(ManifestOf(root_), ManifestOf(whole));
  }
}

}  // namespace
}  // namespace tsar
