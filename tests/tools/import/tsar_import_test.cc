// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/import/import_workspace.h"

#include <chrono>

#include "tests/support/external_writers.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/tools/import/tsar_import_testing.h"

namespace tsar {
namespace {

using testing::HasSubstr;

TEST_F(TsarImportTest, KeepsFormerMapsAndPutsThemBack) {
  ExportAcm(scene_, other_);
  ExpectImportFailure("acm",
                      {"v0.png.geometric.bin", "--overwrite 1", "--restore 1"});
  const MapPaths paths = Paths(scene_[0]);
  WriteText(paths.cost, "exported costs");
  const auto with_costs = ReadTree(root_);
  ExpectSuccess(Import("acm", {"--overwrite", "1"}));
  // They belonged to the former depths.
  EXPECT_FALSE(std::filesystem::exists(paths.cost));
  EXPECT_FALSE(ReadTree(root_) == with_costs);
  // Its own maps may be replaced, and the former ones stay.
  ExpectSuccess(Import("acm", {"--import_costs", "1"}));
  EXPECT_TRUE(std::filesystem::exists(paths.cost));
  ExpectSuccess(Import("acm"));

  const Outcome undone = RunImport({"--restore", "1"});
  EXPECT_EQ(undone.out, "Undid the import of 4 images.\n");
  EXPECT_TRUE(ReadTree(root_) == with_costs);
  ExpectFailure({"--restore", "1"}, {"nothing was imported"});
}

TEST_F(TsarImportTest, TakesAModelInTheFolder0) {
  RemoveStereo(root_);
  ExportPfm();
  std::filesystem::rename(root_ / "sparse", root_ / "0");
  std::filesystem::create_directory(root_ / "sparse");
  ExpectImportFailure("depth", {"sparse: no sparse model", "folder 0"});
  std::filesystem::rename(root_ / "0", root_ / "sparse/0");
  ExpectSuccess(Import("depth"));
  EXPECT_TRUE(std::filesystem::exists(Paths(scene_[0]).depth));
}

TEST_F(TsarImportTest, UndoesAnImportIntoAnEmptyWorkspace) {
  RemoveStereo(root_);
  ExportPfm();
  ExpectSuccess(Import("depth"));
  ExpectSuccess(RunImport({"--restore", "1"}));
  for (const auto& [path, content] : ReadTree(root_ / "stereo")) {
    EXPECT_TRUE(content == "folder" || path == "patch-match.cfg" ||
                path == "fusion.cfg")
        << path;
  }
}

TEST_F(TsarImportTest, LeavesMapsThatAreNewer) {
  const auto before = ReadTree(root_);
  ExportPfm();
  ExpectSuccess(Import("depth", {"--overwrite", "1"}));
  const MapPaths paths = Paths(scene_[1]);
  const auto write_later = [](const ContainedPath& path, const auto& write) {
    const auto time = std::filesystem::last_write_time(path);
    write();
    std::filesystem::last_write_time(path, time + std::chrono::hours(1));
  };
  write_later(paths.depth,
              [&] { WriteDepthMap(paths.depth, Image<float>(96, 72, 3.f)); });
  ExpectImportFailure("depth", {"v1.png.geometric.bin", "--overwrite 1"});
  const std::string later = ReadText(paths.depth);
  ExpectSuccess(RunImport({"--restore", "1"}),
                {"Left these",
                 "stereo/tsar/superseded/depth_maps/v1.png.geometric.bin"});
  auto after = ReadTree(root_);
  EXPECT_EQ(after.extract("stereo/depth_maps/v1.png.geometric.bin").mapped(),
            later);
  auto superseded = after.extract(
      "stereo/tsar/superseded/depth_maps/v1.png.geometric.bin");
  superseded.key() = "stereo/depth_maps/v1.png.geometric.bin";
  std::erase_if(after, [](const auto& entry) {
    return entry.first.starts_with("stereo/tsar");
  });
  after.insert(std::move(superseded));
  EXPECT_TRUE(after == before);
}

TEST_F(TsarImportTest, PrintsTheFirstOfManyWarnings) {
  ImportSummary summary;
  summary.warnings.assign(30, "something");
  std::ostringstream text;
  PrintSummary(summary, text);
  EXPECT_THAT(text.str(),
              HasSubstr("WARNING: something\nWARNING: and 10 more"));
}

TEST_F(TsarImportTest, TellsWhatToDoWithMapsWithoutHoles) {
  for (const int64_t num_with_depth : {0, 979, 980, 1000}) {
    ImportSummary summary;
    summary.num_with_depth = num_with_depth;
    summary.num_pixels = 1000;
    std::ostringstream text;
    PrintSummary(summary, text);
    EXPECT_EQ(text.str().find("--TsarRefine.distrust_unmatched 1") !=
                  std::string::npos,
              num_with_depth >= 980)
        << text.str();
  }
}

TEST_F(TsarImportTest, WarnsOfEmptyMaps) {
  WriteText(other_ / "v0.pfm",
            PfmBytes(96, 72, 1, std::vector<float>(96 * 72, NAN), true));
  RemoveStereo(root_);
  ExpectSuccess(Import("depth"),
                {"Pixels with depth: 0.0 %", "v0.pfm: no pixel has a depth"});
  EXPECT_EQ(ReadDepthMap(Paths(scene_[0]).depth)(9, 9), 0.f);
}

TEST_F(TsarImportTest, RefusesARefinedWorkspace) {
  ExportPfm();
  ExpectRefinable();
  ExpectImportFailure(
      "depth", {"tsar_refine --restore 1"}, {"--overwrite", "1"});
  ExpectFailure({"--restore", "1"}, {"tsar_refine --restore 1"});
}

TEST_F(TsarImportTest, RefusesALockedWorkspace) {
  ExportPfm();
  const WorkspaceLock lock(root_);
  ExpectImportFailure("depth", {"another program"}, {"--overwrite", "1"});
}

TEST_F(TsarImportTest, WarnsOfMapsOfTheOtherTypeOfAnotherSize) {
  WriteText(other_ / "v0.pfm",
            PfmBytes(48, 36, 1, std::vector<float>(48 * 36, 5.f), true));
  ExpectSuccess(Import("depth", {"--overwrite", "1"}),
                {"WARNING: ", "v0.png.photometric.bin", "96 x 72", "48 x 36"});
}

TEST_F(TsarImportTest, BrokenFilesAreOneLineAndNothingIsWritten) {
  ExportAcm(scene_, other_);
  RemoveStereo(root_);
  const std::filesystem::path folder = other_ / "ACMM/2333_00000003";
  const std::string good = ReadText(folder / "normals.dmb");
  WriteText(folder / "normals.dmb", good.substr(0, 1000));
  ExpectImportFailure("acm", {"2333_00000003/normals.dmb", "72"});
  WriteText(folder / "normals.dmb", "");
  ExpectImportFailure("acm", {"2333_00000003/normals.dmb", "shorter"});
  WriteText(folder / "normals.dmb", DmbBytes(2, 1, 3, {1, 2, 3, 4, 5, 6}));
  ExpectImportFailure("acm", {"normals.dmb", "2 x 1", "96 x 72"});
  WriteText(folder / "normals.dmb", DmbBytes(2, 1, 1, {1, 2}));
  ExpectImportFailure("acm", {"normals.dmb", "3 channel"});
  WriteText(folder / "normals.dmb", good);
  ExpectImportFailure("apd", {"depths_geom.dmb", "[version]", "--format"});
  ExpectImportFailure("openmvs", {"depth0000.dmap"});
  ExpectImportFailure("depth", {"PFM", "v0.png"});
  WriteText(other_ / "cams/00000001_cam.txt", "extrinsic 1 2 3");
  ExpectImportFailure("acm", {"00000001_cam.txt", "extrinsic"});
}

TEST_F(TsarImportTest, RefusesFoldersUnderTheNamesOfItsFiles) {
  ExportPfm();
  const MapPaths paths = Paths(scene_.back());
  const std::filesystem::path former = root_ / "stereo/tsar_import/former";
  for (const std::filesystem::path& path :
       {std::filesystem::path(paths.cost),
        former / "normal_maps" / paths.normal.Path().filename()}) {
    std::filesystem::create_directories(path);
    ExpectImportFailure("depth",
                        {path.string(), "move the folder of this name away"},
                        {"--overwrite", "1"});
    std::filesystem::remove_all(path);
  }
}

TEST_F(TsarImportTest, WrongOptionsAreOneLine) {
  ExportPfm();
  const std::string other = other_.string();
  ExpectFailure({}, {"--format is missing"});
  ExpectFailure({"--format", "depth"}, {"--input_path is missing"});
  ExpectFailure({"--format", "mvs", "--input_path", other}, {"openmvs"});
  ExpectFailure({"--format", "depth", "--input_path", "/no/where"},
                {"/no/where", "no such folder"});
  ExpectImportFailure("acm", {"--normal_path"}, {"--normal_path", other});
  ExpectImportFailure(
      "depth", {"/no/where", "no such folder"}, {"--normal_path", "/no/where"});
  ExpectImportFailure("depth", {"depth_scale"}, {"--depth_scale", "-1"});
  ExpectImportFailure("depth", {"--restore"}, {"--restore", "1"});
  std::filesystem::remove_all(root_ / "sparse");
  ExpectImportFailure("depth", {"sparse", "no such folder"});
}

}  // namespace
}  // namespace tsar
