// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/write_back.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/restore.h"

#include "tests/run/store/write_back_testing.h"
#include "tests/support/test_workspace.h"
#include "tests/support/write_refined.h"
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

constexpr MapType kGeometric = MapType::kGeometric;

TEST_F(WriteBackTest, WritesAllFourMapsAndKeepsTheOriginals) {
  ImageRecord record = Record();
  record.counts["filled"] = 7;
  record.seconds["total"] = 0.5;
  record.note = "fine";
  WriteRefined(workspace(), 1, MakeRefinedMaps(42.f), record);
  EXPECT_EQ(CurrentDepth(1), 42.f);
  EXPECT_EQ(OriginalDepth(1), 4.f);
  const cv::Mat confidence =
      cv::imread(workspace().Paths(1, kGeometric).confidence.string(),
                 cv::IMREAD_UNCHANGED);
  ASSERT_EQ(confidence.type(), CV_8UC1);
  EXPECT_EQ(confidence.size(), cv::Size(4, 3));
  EXPECT_EQ(confidence.at<uint8_t>(2, 3), 128);
  const cv::Mat provenance =
      cv::imread(workspace().Paths(1, kGeometric).provenance.string(),
                 cv::IMREAD_UNCHANGED);
  ASSERT_EQ(provenance.type(), CV_8UC1);
  EXPECT_EQ(provenance.cols, 4);
  EXPECT_EQ(provenance.rows, 3);
  EXPECT_EQ(provenance.at<uint8_t>(2, 3), 4);

  const auto written = ReadRecord(workspace().Paths(1, kGeometric).record);
  ASSERT_TRUE(written);
  EXPECT_EQ(written->status, ImageStatus::kDone);
  EXPECT_EQ(written->image, "left/b.png");
  EXPECT_EQ(written->type, "geometric");
  EXPECT_EQ(written->options_hash, "options");
  EXPECT_EQ(written->counts, record.counts);
  EXPECT_EQ(written->seconds, record.seconds);
  EXPECT_EQ(written->note, "fine");
  EXPECT_FALSE(written->version.empty());
  EXPECT_THAT(
      written->depth.written,
      testing::ElementsAre(testing::Field(
          &WrittenMap::hash, HashFile(workspace().DepthPath(1, kGeometric)))));
}

TEST_F(WriteBackTest, WritesPlanesWhereThereAreSome) {
  const std::filesystem::path path = workspace().Paths(1, kGeometric).planes;
  EXPECT_EQ(path, root_ / "stereo/plane_maps/left/b.png.geometric.png");
  RefinedMaps maps = MakeRefinedMaps(42.f);
  WriteRefined(workspace(), 1, maps, Record());
  EXPECT_FALSE(std::filesystem::exists(path));
  maps.planes = Image<uint16_t>(4, 3, 40000);
  WriteRefined(workspace(), 1, maps, Record());
  const cv::Mat planes = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(planes.type(), CV_16UC1);
  ASSERT_EQ(planes.size(), cv::Size(4, 3));
  EXPECT_EQ(planes.at<uint16_t>(2, 3), 40000);
  // Those of an earlier refinement do not outlive it.
  WriteRefined(workspace(), 1, MakeRefinedMaps(43.f), Record());
  EXPECT_FALSE(std::filesystem::exists(path));
  maps.planes = Image<uint16_t>(3, 4, 1);
  ExpectError(ErrorCode::kMismatch, {"left/b.png", "differ in size"}, [&] {
    WriteRefined(workspace(), 1, maps, Record());
  });
  maps.planes = Image<uint16_t>(4, 3, 1);
  WriteRefined(workspace(), 1, maps, Record());
  KeepImage(workspace(), 1, Record());
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(WriteBackTest, KnowsWhatIsDone) {
  EXPECT_FALSE(IsDone(workspace(), 0, "options", {}));
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
  EXPECT_TRUE(IsDone(workspace(), 0, "options", {}));
  EXPECT_FALSE(IsDone(workspace(), 0, "other", {}));
  EXPECT_FALSE(IsDone(workspace(), 1, "options", {}));
  EXPECT_FALSE(
      IsDone(Workspace(root_, MapType::kPhotometric), 0, "options", {}));
  std::filesystem::remove(workspace().Paths(0, kGeometric).confidence);
  EXPECT_FALSE(IsDone(workspace(), 0, "options", {}));
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
  WriteNormalMap(UserPath(workspace().Paths(0, kGeometric).normal),
                 Image<Vec3f>(4, 3, Vec3f{1, 0, 0}));
  EXPECT_FALSE(IsDone(workspace(), 0, "options", {}));
}

TEST_F(WriteBackTest, OtherInputsAreNotDone) {
  const std::map<std::string, std::string> inputs = {{"camera", "0123"},
                                                     {"photo", "4567"}};
  ImageRecord record = Record();
  record.inputs = inputs;
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), record);
  EXPECT_EQ(ReadRecord(workspace().Paths(0, kGeometric).record)->inputs,
            inputs);
  EXPECT_TRUE(IsDone(workspace(), 0, "options", inputs));
  EXPECT_FALSE(IsDone(workspace(), 0, "options", {}));
  EXPECT_FALSE(IsDone(
      workspace(), 0, "options", {{"camera", "0123"}, {"photo", "4568"}}));
  EXPECT_FALSE(IsDone(workspace(), 0, "options", {{"camera", "0123"}}));
}

// A run may end after any step, in the first run as in one with other options
// (42 is then in place). The renaming itself may be cut between two files.
TEST_F(WriteBackTest, AnInterruptionAnywhereLosesNothing) {
  for (const bool refined_before : {false, true}) {
    for (int num_steps = 0; num_steps <= 5; ++num_steps) {
      SCOPED_TRACE(num_steps);
      std::filesystem::remove_all(root_);
      MakeTestWorkspace(root_);
      const auto clean = Snapshot(root_);
      const float before = refined_before ? 42.f : 2.f;
      if (refined_before) {
        WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record("old"));
      }
      {
        WriteBack write_back(workspace(), 0, Record());
        const std::vector<std::function<void()>> steps = {
            [&] { write_back.PrepareFiles(MakeRefinedMaps(43.f)); },
            [&] { write_back.KeepOriginals(); },
            [&] { write_back.RecordWriting(); },
            [&] { write_back.RenameFiles(); },
            [&] { write_back.RecordDone(); }};
        for (int step = 0; step < num_steps; ++step) {
          steps[step]();
        }
        // A killed program leaves its temporaries: keep copies of them.
        if (num_steps >= 1 && num_steps <= 3) {
          const auto path = workspace().Paths(0, kGeometric).depth.string();
          WriteText(path + AtomicFile::kTemporarySuffix, "half");
        }
      }
      EXPECT_EQ(CurrentDepth(0), num_steps >= 4 ? 43.f : before);
      EXPECT_EQ(OriginalDepth(0), 2.f);
      EXPECT_EQ(IsDone(workspace(), 0, "options", {}), num_steps == 5);

      // Going on works, and so does undoing.
      WriteRefined(workspace(), 0, MakeRefinedMaps(44.f), Record());
      EXPECT_EQ(CurrentDepth(0), 44.f);
      EXPECT_EQ(OriginalDepth(0), 2.f);
      EXPECT_EQ(Restore(root_).num_restored, 1);
      EXPECT_EQ(Snapshot(root_), clean);
    }
  }
}

// So readers need not wait for it.
TEST_F(WriteBackTest, PreparingFilesChangesNoFileThatIsRead) {
  for (const float earlier : {0.f, 42.f}) {
    if (earlier > 0.f) {
      WriteRefined(workspace(), 0, MakeRefinedMaps(earlier), Record());
    }
    const auto before = Snapshot(root_);
    {
      WriteBack write_back(workspace(), 0, Record());
      write_back.PrepareFiles(MakeRefinedMaps(43.f));
      const auto prepared = Snapshot(root_);
      EXPECT_GT(prepared.size(), before.size());
      for (const auto& [path, content] : before) {
        EXPECT_EQ(prepared.at(path), content) << path;
      }
      EXPECT_EQ(OriginalDepth(0), 2.f);
    }
    for (const auto& [path, content] : Snapshot(root_)) {
      if (content != "folder") {
        EXPECT_EQ(before.at(path), content) << path;
      }
    }
  }
}

TEST_F(WriteBackTest, RefusesBadMapsAndChangesNothing) {
  const auto clean = Snapshot(root_ / "stereo/depth_maps");
  RefinedMaps maps = MakeRefinedMaps(42.f);
  maps.normal = Image<Vec3f>(3, 4);
  ExpectError(ErrorCode::kMismatch, {"a.png", "size"}, [&] {
    WriteRefined(workspace(), 0, maps, Record());
  });
  maps = MakeRefinedMaps(42.f);
  maps.normal(1, 1).x = std::nanf("");
  ExpectError(ErrorCode::kMismatch, {"not finite"}, [&] {
    WriteRefined(workspace(), 0, maps, Record());
  });
  EXPECT_EQ(Snapshot(root_ / "stereo/depth_maps"), clean);
}

TEST_F(WriteBackTest, RefusesImagesWithoutMaps) {
  const MapPaths paths = workspace().Paths(0, kGeometric);
  std::filesystem::remove(paths.normal);
  ExpectError(ErrorCode::kNotFound, {paths.normal.string()}, [&] {
    WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
  });
  EXPECT_EQ(CurrentDepth(0), 2.f);
}

TEST_F(WriteBackTest, ManifestListsEveryImage) {
  ImageRecord record = Record();
  record.counts["filled"] = 7;
  record.seconds["total"] = 0.5;
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), record);
  WriteRefined(workspace(), 1, MakeRefinedMaps(42.f), record);
  record = Record("other options");
  KeepImage(workspace(), 2, record);
  const Manifest manifest =
      BuildManifest(workspace(), {{"eta", "0.8"}}, "options");
  EXPECT_EQ(manifest.NumImages(ImageStatus::kDone), 2);
  EXPECT_EQ(manifest.NumImages(ImageStatus::kPending), 1);
  EXPECT_EQ(manifest.counts.at("filled"), 14);
  EXPECT_DOUBLE_EQ(manifest.seconds.at("total"), 1.0);
  WriteManifest(workspace(), manifest);
  const auto json =
      nlohmann::json::parse(ReadText(root_ / "stereo/tsar/manifest.json"));
  EXPECT_EQ(json["type"], "geometric");
  EXPECT_EQ(json["options"]["eta"], "0.8");
  EXPECT_EQ(json["num_images"]["done"], 2);
  ASSERT_EQ(json["images"].size(), 3u);
  EXPECT_EQ(json["images"][1]["image"], "left/b.png");
  EXPECT_EQ(json["images"][1]["status"], "done");
  EXPECT_EQ(json["images"][2]["status"], "pending");
}

// Names are bytes; a record must be writable for any of them.
TEST_F(WriteBackTest, RecordsNamesThatAreNotUtf8) {
  ImageRecord record = Record();
  record.image = "bad \xFF name";
  record.note = "bad \xFF byte";
  record.type = "geometric";
  const auto path = folder_.Path() / "bad \xFF name.geometric.json";
  WriteRecord(UserPath(path), record);
  EXPECT_TRUE(ReadRecord(path));
}

}  // namespace
}  // namespace tsar
