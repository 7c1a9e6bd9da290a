// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/shard_record.h"
#include "colmap_tsar/run/store/workspace_lock.h"

#include <functional>
#include <sstream>
#include <thread>

#include "tests/run/refine_shard_fixture.h"
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

TEST_F(RefineShardTest, AnyNumberOfShardsGivesTheBytesOfOneRun) {
  const std::filesystem::path whole = Whole();
  for (const int count : {1, 3, 7}) {
    Redraw();
    RunAll("observe", count);
    RunAll("compose", count);
    EXPECT_TRUE(HasShards());
    EXPECT_TRUE(std::filesystem::exists(Evidence(0)));
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
      // What others read must not be what a shard is just writing.
      for (int view = 0; view < 4; ++view) {
        EXPECT_EQ(std::filesystem::exists(Evidence(view)), scene_planes);
        EXPECT_EQ(std::filesystem::exists(Paths(view).original_depth),
                  pass == std::string("compose"));
      }
    }
    Run("merge", "", refine);
    EXPECT_TRUE(ResultOf(root_) == ResultOf(whole));
  }
}

TEST_F(RefineShardTest, TellsWhatItDid) {
  const RunSummary observed = Run("observe", "0/2");
  EXPECT_EQ(observed.num_images, 2);
  EXPECT_EQ(observed.num_observed, 2);
  EXPECT_EQ(observed.num_refined, 0);
  EXPECT_EQ(Run("observe", "0/2").num_skipped, 2);
  std::ostringstream text;
  PrintSummary(observed, text);
  EXPECT_THAT(text.str(), testing::HasSubstr("Shard 0 of 2, 2 images: 2 obs"));
  EXPECT_THAT(text.str(), testing::HasSubstr("--TsarRefine.pass model"));
  Run("observe", "1/2");
  const RunSummary modeled = Run("model");
  text.str("");
  PrintSummary(modeled, text);
  EXPECT_THAT(text.str(),
              testing::HasSubstr("4 images: the planes of the scene have been "
                                 "found"));
  EXPECT_THAT(text.str(), testing::HasSubstr("--TsarRefine.pass compose"));
  const RunSummary composed = Run("compose", "1/2");
  EXPECT_EQ(composed.num_refined, 2);
  text.str("");
  PrintSummary(composed, text);
  EXPECT_THAT(text.str(), testing::HasSubstr("Shard 1 of 2, 2 images: 2 ref"));
  EXPECT_THAT(text.str(), testing::HasSubstr("--TsarRefine.pass merge"));
  EXPECT_EQ(Run("compose", "1/2").num_skipped, 2);
  Run("compose", "0/2");
  text.str("");
  PrintSummary(Run("merge"), text);
  EXPECT_THAT(text.str(), testing::HasSubstr("4 images: 4 refined\n"));
  EXPECT_THAT(text.str(), testing::HasSubstr("colmap stereo_fusion"));
  const nlohmann::json manifest =
      nlohmann::json::parse(ReadText(root_ / "stereo/tsar/manifest.json"));
  EXPECT_EQ(manifest["runtime"]["shards"], "2");
  EXPECT_EQ(manifest["runtime"]["shard 1 of 2, used"], "1 CPU thread");
}

TEST_F(RefineShardTest, ThePassesComeInTheirOrder) {
  ExpectRefusal(
      ErrorCode::kNotFound, {"0, 1, 2 have", "observe"}, "compose", "0/3");
  ExpectRefusal(ErrorCode::kNotFound, {"4 of 4 images"}, "merge");
  Run("observe", "1/3");
  ExpectRefusal(
      ErrorCode::kNotFound, {"0, 2 have", "observe"}, "compose", "1/3");
  ExpectRefusal(ErrorCode::kNotFound, {"0, 1, 2 have", "compose"}, "merge");
  ExpectRefusal(ErrorCode::kNotFound, {"0, 2 have", "observe"}, "model");
  Run("observe", "0/3");
  Run("observe", "2/3");
  const Tree maps = ReadTree(root_ / "stereo/depth_maps");
  ExpectError(ErrorCode::kNotFound, {"planes.bin", "pass model first"}, [&] {
    Run("compose", "2/3");
  });
  EXPECT_TRUE(ReadTree(root_ / "stereo/depth_maps") == maps);
  Run("model");
  // Once more, it has nothing to do.
  const Tree modeled = ReadTree(root_);
  Run("model");
  EXPECT_TRUE(ReadTree(root_) == modeled);
  Run("compose", "2/3");
  ExpectRefusal(ErrorCode::kNotFound, {"0, 1 have", "compose"}, "merge");
  // What is observed anew has to be composed anew.
  Run("compose", "0/3");
  Run("compose", "1/3");
  Run("observe", "1/3");
  ExpectRefusal(ErrorCode::kNotFound, {"3 shards, 1 has", "compose"}, "merge");
  EXPECT_EQ(Run("compose", "1/3").num_refined, 0);
  Run("merge");
  EXPECT_FALSE(HasShards());
  // A merge that was killed at its very end, or is run twice.
  const Tree merged = ReadTree(root_);
  EXPECT_EQ(Run("merge").num_refined, 4);
  EXPECT_TRUE(ReadTree(root_) == merged);
}

TEST_F(RefineShardTest, AMergeThatWasKilledGoesOn) {
  RunAll("observe", 2);
  RunAll("compose", 2);
  const std::filesystem::path records = folder_.Path() / "records";
  std::filesystem::copy(root_ / "stereo/tsar/shards", records);
  Run("merge");
  const Tree merged = ReadTree(root_);
  // Between two of its steps.
  std::filesystem::copy(records, root_ / "stereo/tsar/shards");
  Run("merge");
  EXPECT_TRUE(ReadTree(root_) == merged);
  std::filesystem::create_directories(root_ / "stereo/tsar/shards.removed");
  Run("merge");
  EXPECT_TRUE(ReadTree(root_) == merged);
}

TEST_F(RefineShardTest, AllShardsMustBeRunAlike) {
  Run("observe", "0/2");
  RefineOptions others;
  others.segment = false;
  ExpectRefusal(ErrorCode::kMismatch,
                {"observe-0-of-2.json", "segment 1", "with 0"},
                Options(root_, "observe", "1/2"),
                others);
  ExpectRefusal(ErrorCode::kMismatch, {"one of 2"}, "observe", "1/3");
  WorkspaceRefineOptions photometric = Options(root_, "observe", "1/2");
  photometric.input_type = MapType::kPhotometric;
  ExpectRefusal(ErrorCode::kMismatch, {"geometric maps"}, photometric);
  Run("observe", "1/2");
  ExpectRefusal(ErrorCode::kMismatch,
                {"segment"},
                Options(root_, "compose", "1/2"),
                others);
  RunAll("compose", 2);
  ExpectRefusal(
      ErrorCode::kMismatch, {"segment"}, Options(root_, "merge"), others);

  const std::filesystem::path path = GetShardPath(root_, "observe", 0, 2);
  ShardRecord record = ReadShardRecord(path);
  record.version = "0.0.1";
  WriteShardRecord(root_, record);
  ExpectRefusal(ErrorCode::kMismatch, {"0.0.1"}, "compose", "1/2");
  WriteText(path, "{");
  ExpectRefusal(ErrorCode::kCorrupt, {path.string()}, "compose", "1/2");
  // As the message says.
  std::filesystem::remove_all(root_ / "stereo/tsar/shards");
  RunAll("observe", 3, others);
  RunAll("compose", 3, others);
  EXPECT_EQ(Run("merge", "", others).num_refined, 4);
  EXPECT_TRUE(ResultOf(root_) == ResultOf(Whole(others)));
}

TEST_F(RefineShardTest, ListsOfOtherImagesAreSeen) {
  Run("observe", "0/2");
  const std::string config = ReadText(root_ / "stereo/patch-match.cfg");
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\nv1.png\nv1.png\nv0.png\nv3.png\n__all__\n");
  ExpectRefusal(ErrorCode::kMismatch, {"patch-match.cfg"}, "observe", "1/2");
  WriteText(root_ / "stereo/patch-match.cfg", config);
  Run("observe", "1/2");
}

TEST_F(RefineShardTest, RefusesOptionsThatContradictEachOther) {
  ExpectRefusal(ErrorCode::kBadOption, {"shard", "observe"}, "all", "0/2");
  ExpectRefusal(ErrorCode::kBadOption, {"shard"}, "merge", "0/2");
  ExpectRefusal(ErrorCode::kBadOption, {"shard", "model"}, "model", "0/2");
  WorkspaceRefineOptions options = Options(root_, "observe", "0/2");
  options.output_path = folder_.Path() / "out";
  ExpectRefusal(ErrorCode::kBadOption, {"output_path", "cp -as"}, options);
  // One of one is all.
  EXPECT_EQ(Run("all", "0/1").num_refined, 4);
  EXPECT_FALSE(HasShards());
}

TEST_F(RefineShardTest, SaysThatAnotherMachineHadBegun) {
  Run("observe", "0/2");
  const auto warnings_for = [&](const std::string& host, bool is_complete) {
    ShardRecord record = ReadShardRecord(GetShardPath(root_, "observe", 0, 2));
    record.is_complete = is_complete;
    if (!host.empty()) {
      record.runtime["host"] = host;
    }
    WriteShardRecord(root_, record);
    testing::internal::CaptureStderr();
    Run("observe", "0/2");
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_THAT(warnings_for("far-away", false),
              testing::HasSubstr("shard 0 of 2 was begun on far-away"));
  EXPECT_THAT(warnings_for("far-away", true),
              testing::Not(testing::HasSubstr("far-away")));
  EXPECT_THAT(warnings_for("", false),
              testing::Not(testing::HasSubstr("was begun on")));
}

TEST_F(RefineShardTest, WholeRunsTakeOverWhatShardsLeft) {
  const std::filesystem::path whole = Whole();
  RunAll("observe", 3);
  Run("model");
  Run("compose", "1/3");
  EXPECT_GT(Run("all").num_skipped, 0);
  EXPECT_FALSE(HasShards());
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

TEST_F(RefineShardTest, AFailureIsToldByItsShardAndByTheMerge) {
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
    } catch (const Error&) {
      ++num_failures;
    }
  }
  EXPECT_EQ(num_failures, 1);
  ExpectRefusal(ErrorCode::kNotFound, {"v3.png: ", "confidence_maps"}, "merge");
  std::filesystem::remove_all(temporary);
  RunAll("compose", 2);
  Run("merge");
  EXPECT_TRUE(ResultOf(root_) == ResultOf(Whole()));
}

// As where the disk is full.
TEST_F(RefineShardTest, AFailureThatCannotBeNotedIsToldStill) {
  Run("observe");
  Run("model");
  std::filesystem::create_directories(Paths(3).confidence.string() +
                                      AtomicFile::kTemporarySuffix +
                                      "/in_the_way");
  const std::filesystem::path record = GetShardPath(root_, "compose", 0, 1);
  ExpectError(ErrorCode::kIo, {Paths(3).confidence.string()}, [&] {
    Refine(Options(root_, "compose"), {}, [&] {
      std::filesystem::create_directories(
          record.string() + AtomicFile::kTemporarySuffix + "/in_the_way");
      return false;
    });
  });
  EXPECT_THAT(ReadText(record), testing::Not(testing::HasSubstr("in_the_way")));
}

TEST_F(RefineShardTest, WorksOnAnOutputWorkspaceInPlace) {
  const Tree before = ReadTree(root_);
  const std::filesystem::path output = folder_.Path() / "out";
  WorkspaceRefineOptions whole = Options(root_);
  whole.output_path = output;
  Refine(whole);
  const Tree expected = ResultOf(output);
  RefineOptions others;
  others.segment = false;
  others.confirmed_depths = false;
  for (const RefineOptions& refine : {others, RefineOptions()}) {
    for (const char* pass : {"observe", "compose"}) {
      if (pass == std::string("compose")) {
        Refine(Options(output, "model"), refine);
      }
      for (const char* shard : {"0/2", "1/2"}) {
        Refine(Options(output, pass, shard), refine);
      }
    }
    Refine(Options(output, "merge"), refine);
    EXPECT_EQ(ResultOf(output) == expected, refine.segment);
  }
  EXPECT_TRUE(ReadTree(root_) == before);
}

}  // namespace
}  // namespace tsar
