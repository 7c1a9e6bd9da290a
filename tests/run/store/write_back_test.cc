// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/write_back.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/view/refine_option_list.h"

#include "tests/run/store/write_back_testing.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"
#include <nlohmann/json.hpp>

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
  const MapPaths paths = workspace().Paths(1, kGeometric);
  for (const auto& [path, value] :
       {std::pair(paths.confidence, 128), {paths.provenance, 4}}) {
    const Image<uint8_t> map = ReadGrayPng(path);
    EXPECT_EQ(map.Width(), 4);
    EXPECT_EQ(map.Height(), 3);
    EXPECT_EQ(map(3, 2), value);
  }

  const auto written = ReadRecord(workspace().Paths(1, kGeometric).record);
  ASSERT_TRUE(written);
  EXPECT_EQ(written->status, ImageStatus::kDone);
  EXPECT_EQ(written->image, "left/b.png");
  EXPECT_EQ(written->type, "geometric");
  EXPECT_EQ(written->options_hash, "options");
  EXPECT_EQ(written->counts, record.counts);
  EXPECT_EQ(written->seconds, record.seconds);
  EXPECT_EQ(written->note, "fine");
  EXPECT_TRUE(written->Has("depth", workspace().Paths(1, kGeometric).depth));
  EXPECT_EQ(written->files.at("depth").front().hash,
            HashFile(workspace().Paths(1, kGeometric).depth));
}

TEST_F(WriteBackTest, WritesPlanesAndSigmaWhereThereAreSome) {
  const auto clean = ReadTree(root_);
  const MapPaths paths = workspace().Paths(1, kGeometric);
  EXPECT_EQ(paths.planes.Path(),
            root_ / "stereo/plane_maps/left/b.png.geometric.png");
  EXPECT_EQ(paths.sigma.Path(),
            root_ / "stereo/sigma_maps/left/b.png.geometric.npy");
  const auto expect_none = [&] {
    EXPECT_FALSE(std::filesystem::exists(paths.planes));
    EXPECT_FALSE(std::filesystem::exists(paths.sigma));
  };
  RefinedMaps maps = MakeRefinedMaps(42.f);
  WriteRefined(workspace(), 1, maps, Record());
  expect_none();
  maps.planes = Image<uint16_t>(4, 3, 40000);
  maps.sigma = Image<uint16_t>(4, 3, ToPositiveHalf(0.25f));
  WriteRefined(workspace(), 1, maps, Record());
  EXPECT_EQ(ReadGray16Png(paths.planes)(3, 2), 40000);
  EXPECT_EQ(ReadSigmaMap(paths.sigma)(3, 2), 0.25f);
  // Those of an earlier refinement do not outlive it.
  WriteRefined(workspace(), 1, MakeRefinedMaps(43.f), Record());
  expect_none();
  WriteRefined(workspace(), 1, maps, Record());
  KeepImage(workspace(), 1, Record());
  expect_none();
  WriteRefined(workspace(), 1, maps, Record());
  Restore(root_);
  EXPECT_EQ(ReadTree(root_), clean);
}

// What is missing, damaged or made from something else is made again.
TEST_F(WriteBackTest, IsDoneWithAllItsFilesAndItsInputsAlone) {
  RefinedMaps maps = MakeRefinedMaps(42.f);
  maps.planes = Image<uint16_t>(4, 3, 7);
  maps.sigma = Image<uint16_t>(4, 3, 1);
  const MapPaths paths = workspace().Paths(0, kGeometric);
  std::vector<const ContainedPath*> files = {&paths.depth, &paths.normal};
  for (const ResultFile& file : ResultFiles(paths)) {
    files.push_back(file.path);
  }
  EXPECT_FALSE(IsDone(workspace(), 0, Record()));
  for (const ContainedPath* file : files) {
    SCOPED_TRACE(file->string());
    const auto expect_done = [&] {
      WriteRefined(workspace(), 0, maps, Record());
      EXPECT_TRUE(IsDone(workspace(), 0, Record()));
    };
    expect_done();
    const std::string bytes = ReadText(*file);
    WriteText(*file, bytes);  // Copied without its time.
    EXPECT_TRUE(IsDone(workspace(), 0, Record()));
    WriteText(*file, bytes.substr(1));
    EXPECT_FALSE(IsDone(workspace(), 0, Record()));
    expect_done();
    std::filesystem::remove(*file);
    EXPECT_FALSE(IsDone(workspace(), 0, Record()));
    expect_done();
  }
  for (std::string ImageRecord::*field : {&ImageRecord::options_hash,
                                          &ImageRecord::inputs,
                                          &ImageRecord::planes}) {
    ImageRecord other = Record();
    other.*field += " and another one";
    EXPECT_FALSE(IsDone(workspace(), 0, other));
  }
  EXPECT_FALSE(IsDone(workspace(), 1, Record()));
  EXPECT_FALSE(IsDone(Workspace(root_, MapType::kPhotometric), 0, Record()));
  KeepImage(workspace(), 0, Record());
  EXPECT_FALSE(IsDone(workspace(), 0, Record()));
}

TEST_F(WriteBackTest, RefusesBadMapsAndChangesNothing) {
  const auto clean = ReadTree(root_ / "stereo/depth_maps");
  RefinedMaps maps = MakeRefinedMaps(42.f);
  maps.normal(1, 1).x = std::nanf("");
  ExpectError(ErrorCode::kMismatch, {"not finite"}, [&] {
    WriteRefined(workspace(), 0, maps, Record());
  });
  EXPECT_EQ(ReadTree(root_ / "stereo/depth_maps"), clean);
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
  RefineOptions options;
  ImageRecord record = Record(HashRefineOptions(options));
  record.counts["filled"] = 7;
  record.seconds["total"] = 0.5;
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), record);
  WriteRefined(workspace(), 1, MakeRefinedMaps(42.f), record);
  KeepImage(workspace(), 2, Record("other options"));
  EXPECT_TRUE(ReadManifestInputs(workspace()).inputs.empty());
  const Manifest manifest =
      BuildManifest(workspace(), options, {{"the photo of a.png", "1@2"}});
  EXPECT_EQ(manifest.NumImages(ImageStatus::kPending), 1);
  EXPECT_EQ(manifest.counts.at("filled"), 14);
  EXPECT_DOUBLE_EQ(manifest.seconds.at("total"), 1.0);
  WriteManifest(workspace(), manifest);
  EXPECT_EQ(ReadManifestInputs(workspace()).inputs, manifest.inputs);
  EXPECT_EQ(ReadManifestInputs(workspace()).version, manifest.version);
  const auto json =
      nlohmann::json::parse(ReadText(root_ / "stereo/tsar/manifest.json"));
  EXPECT_EQ(json["type"], "geometric");
  EXPECT_EQ(json["options"], RefineOptionsText(options));
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
  const auto path = folder_.Path() / "bad \xFF name.geometric.json";
  WriteRecord(UserPath(path), record);
  EXPECT_TRUE(ReadRecord(path));
}

}  // namespace
}  // namespace tsar
