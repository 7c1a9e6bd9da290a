// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/run/store/write_back.h"

#include "tests/run/store/write_back_testing.h"
#include "tests/support/test_workspace.h"
#include "tests/support/write_refined.h"
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

constexpr MapType kGeometric = MapType::kGeometric;

// The depth map was renamed, the normal map not yet.
TEST_F(WriteBackTest, StoredOriginalsAreReadWhateverBecomesOfTheMaps) {
  StoreOriginals(workspace(), 1);
  StoreOriginals(workspace(), 1);  // As a run that goes on does.
  EXPECT_EQ(CurrentDepth(1), 4.f);
  EXPECT_FALSE(IsDone(workspace(), 1, "options", {}));
  // Another program, which this one cannot see, gives the maps other content.
  const MapPaths paths = workspace().Paths(1, kGeometric);
  Workspace trusting = workspace();
  trusting.TrustStoredOriginals();
  const float other_original = OriginalDepth(0);
  WriteBack write_back(workspace(), 1, Record());
  write_back.PrepareFiles(MakeRefinedMaps(42.f));
  for (const auto& step : {&WriteBack::KeepOriginals,
                           &WriteBack::RecordWriting,
                           &WriteBack::RenameFiles}) {
    (write_back.*step)();
    EXPECT_EQ(trusting.ReadOriginalMaps(1, kGeometric).depth(0, 0), 4.f);
  }
  std::filesystem::remove(paths.record);
  EXPECT_EQ(trusting.ReadOriginalMaps(1, kGeometric).depth(0, 0), 4.f);
  // An image of which nothing is stored has its original in place.
  EXPECT_EQ(trusting.ReadOriginalMaps(0, kGeometric).depth(0, 0),
            other_original);
  std::filesystem::remove(workspace().Paths(0, kGeometric).depth);
  EXPECT_THROW(trusting.ReadOriginalMaps(0, kGeometric), Error);
}

TEST_F(WriteBackTest, StoringOriginalsCanBeUndoneAndNewerMapsCount) {
  const auto before = Snapshot(root_);
  StoreOriginals(workspace(), 1);
  {
    const WorkspaceLock lock(root_);
    Restore(root_);
  }
  EXPECT_EQ(Snapshot(root_), before);
  StoreOriginals(workspace(), 1);
  WriteTestMaps(root_, "left/b.png", kGeometric, 9.f);
  EXPECT_EQ(OriginalDepth(1), 9.f);
}

TEST_F(WriteBackTest, RestoreGivesBackTheSameBytesForAllTypes) {
  const auto clean = Snapshot(root_);
  const Workspace photometric(root_, MapType::kPhotometric);
  for (int image = 0; image < 3; ++image) {
    WriteRefined(workspace(), image, MakeRefinedMaps(42.f), Record());
    WriteRefined(photometric, image, MakeRefinedMaps(43.f), Record());
  }
  WriteManifest(workspace(), BuildManifest(workspace(), {}, "options"));
  RestoreResult result;
  {
    const WorkspaceLock lock(root_);
    result = Restore(root_);
  }
  EXPECT_EQ(result.num_restored, 6);
  EXPECT_TRUE(result.kept.empty());
  EXPECT_TRUE(result.superseded.empty());
  EXPECT_EQ(Snapshot(root_), clean);
  ExpectError(ErrorCode::kNotFound,
              {(root_ / "stereo/tsar").string(), "nothing to restore"},
              [&] { Restore(root_); });
}

TEST_F(WriteBackTest, RestoreLeavesForeignFilesAlone) {
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
  WriteText(root_ / "stereo/confidence_maps/mine.bin", "mine");
  Restore(root_);
  EXPECT_EQ(ReadText(root_ / "stereo/confidence_maps/mine.bin"), "mine");
}

TEST_F(WriteBackTest, DoesNotGuessWithoutARecord) {
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
  const MapPaths paths = workspace().Paths(0, kGeometric);
  std::filesystem::remove(paths.record);
  ExpectError(ErrorCode::kMismatch,
              {paths.depth.string(), paths.original_depth.string()},
              [&] { workspace().ReadOriginalMaps(0, kGeometric); });
  EXPECT_EQ(CurrentDepth(0), 42.f);
  EXPECT_EQ(Restore(root_).num_restored, 1);
  EXPECT_EQ(CurrentDepth(0), 2.f);
}

TEST_F(WriteBackTest, RefusesBrokenRecordsAndRestoresFromThem) {
  const MapPaths paths = workspace().Paths(0, kGeometric);
  for (const char* text : {"", "{", "[]", "{}", "null", R"({"version":1})"}) {
    SCOPED_TRACE(text);
    WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
    WriteText(paths.record, text);
    ExpectError(ErrorCode::kCorrupt, {paths.record.string()}, [&] {
      IsDone(workspace(), 0, "options", {});
    });
    EXPECT_EQ(Restore(root_).num_restored, 1);
    EXPECT_EQ(CurrentDepth(0), 2.f);
  }
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
  const auto good = nlohmann::json::parse(ReadText(paths.record));
  for (const auto& [key, value] : good.items()) {
    SCOPED_TRACE(key);
    nlohmann::json bad = good;
    bad[key] = 1.5;
    WriteText(paths.record, bad.dump());
    ExpectError(ErrorCode::kCorrupt, {paths.record.string()}, [&] {
      ReadRecord(paths.record);
    });
    bad.erase(key);
    WriteText(paths.record, bad.dump());
    ExpectError(ErrorCode::kCorrupt, {paths.record.string()}, [&] {
      ReadRecord(paths.record);
    });
  }
}

TEST_F(WriteBackTest, KeepsImagesAndPutsRefinedOnesBack) {
  const auto clean = Snapshot(root_ / "stereo/depth_maps");
  ImageRecord record = Record();
  record.note = "no source view";
  KeepImage(workspace(), 0, record);
  WriteRefined(workspace(), 1, MakeRefinedMaps(42.f), Record("old"));
  KeepImage(workspace(), 1, record);
  EXPECT_EQ(Snapshot(root_ / "stereo/depth_maps"), clean);
  for (int image : {0, 1}) {
    const MapPaths paths = workspace().Paths(image, kGeometric);
    const auto written = ReadRecord(paths.record);
    ASSERT_TRUE(written);
    EXPECT_EQ(written->status, ImageStatus::kKept);
    EXPECT_EQ(written->note, "no source view");
    EXPECT_FALSE(std::filesystem::exists(paths.confidence));
    EXPECT_FALSE(std::filesystem::exists(paths.original_depth));
    EXPECT_FALSE(IsDone(workspace(), image, "options", {}));
  }
  EXPECT_EQ(OriginalDepth(1), 4.f);
}

}  // namespace
}  // namespace tsar
