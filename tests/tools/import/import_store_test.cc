// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_store.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/tools/import/import_record.h"

#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

ImportedMaps MakeMaps(float depth, bool has_cost = false) {
  ImportedMaps maps;
  maps.depth = Image<float>(4, 3, depth);
  maps.normal = Image<Vec3f>(4, 3, Vec3f{0.f, 0.f, -1.f});
  if (has_cost) {
    maps.cost = {4, 3, 2, std::vector<float>(24, depth / 100.f)};
  }
  return maps;
}

class ImportStoreTest : public testing::Test {
 protected:
  void SetUp() override { MakeTestWorkspace(root_); }

  void Write(float depth, bool has_cost = false) const {
    WriteImported(root_, kName, kType, MakeMaps(depth, has_cost));
  }
  MapPaths Paths() const { return GetMapPaths(root_, kName, kType); }
  std::filesystem::path Former(const std::string& folder) const {
    return GetImportFolder(root_) / "former" / folder /
           (kName + ".geometric.bin");
  }

  const std::string kName = "left/b.png";
  static constexpr MapType kType = MapType::kGeometric;
  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

TEST_F(ImportStoreTest, KeepsTheFirstFormerMapsThroughSeveralImports) {
  const auto before = ReadTree(root_);
  const std::string depth = ReadText(Paths().depth);
  for (const float value : {50.f, 60.f, 50.f}) {
    Write(value, value == 60.f);
    EXPECT_EQ(ReadDepthMap(Paths().depth)(0, 0), value);
    EXPECT_EQ(ReadText(Former("depth_maps")), depth);
    EXPECT_EQ(std::filesystem::exists(Paths().cost), value == 60.f);
    RequireNoForeignMaps(root_, kName, kType);
  }
  const UndoResult result = UndoImport(root_);
  EXPECT_EQ(result.num_images, 1);
  EXPECT_TRUE(result.kept.empty());
  EXPECT_TRUE(result.superseded.empty());
  EXPECT_TRUE(ReadTree(root_) == before);
}

TEST_F(ImportStoreTest, RefusesMapsOfOthers) {
  ExpectError(ErrorCode::kUnsupported,
              {Paths().depth.string(), "overwrite 1"},
              [&] { RequireNoForeignMaps(root_, kName, kType); });
  RequireNoForeignMaps(root_, "other.png", kType);
  std::filesystem::remove(Paths().depth);
  ExpectError(ErrorCode::kUnsupported,
              {Paths().normal.string(), "overwrite 1"},
              [&] { RequireNoForeignMaps(root_, kName, kType); });
}

TEST_F(ImportStoreTest, MapsThatComeLaterAreTheFormerOnesOfTheNextImport) {
  Write(50.f);
  WriteTestMaps(root_, kName, kType, 77.f);
  const std::string later = ReadText(Paths().depth);
  Write(60.f);
  EXPECT_EQ(ReadText(Former("depth_maps")), later);
  UndoImport(root_);
  EXPECT_EQ(ReadText(Paths().depth), later);
}

// What a program leaves that is killed before the maps get their names.
TEST_F(ImportStoreTest, UndoesAnImportThatBarelyBegan) {
  const auto before = ReadTree(root_);
  const std::string record =
      "stereo/tsar_import/records/" + kName + ".geometric.json";
  Write(50.f);
  const std::string text = ReadText(root_ / record);
  UndoImport(root_);
  ASSERT_TRUE(ReadTree(root_) == before);
  WriteText(root_ / record, text);
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    std::filesystem::create_directories(Former(folder).parent_path());
    std::filesystem::create_hard_link(
        root_ / "stereo" / folder / (kName + ".geometric.bin"), Former(folder));
  }
  const UndoResult result = UndoImport(root_);
  EXPECT_TRUE(result.superseded.empty());
  EXPECT_TRUE(ReadTree(root_) == before);
}

// What one leaves that is killed while it writes its first map.
TEST_F(ImportStoreTest, UndoesAnImportThatHasOnlyTemporaries) {
  const auto before = ReadTree(root_);
  ExpectError(ErrorCode::kNotFound, {"nothing was imported"}, [&] {
    UndoImport(root_);
  });
  for (const ContainedPath& path : {Paths().depth, Paths().normal}) {
    WriteText(path.string() + AtomicFile::kTemporarySuffix, "half a map");
    EXPECT_EQ(UndoImport(root_).num_images, 0);
    EXPECT_TRUE(ReadTree(root_) == before);
  }
}

// As for the originals of tsar_refine.
TEST_F(ImportStoreTest, FormerMapsThatWereChangedAreAConflict) {
  for (const std::string folder : {"depth_maps", "normal_maps", "cost_maps"}) {
    SCOPED_TRACE(folder);
    WriteText(Paths().cost, "not read");
    Write(50.f, true);
    Write(60.f, true);  // The record of the first import is not lost.
    std::string bytes = ReadText(Former(folder));
    bytes.back() ^= 1;
    WriteText(Former(folder), bytes);
    const auto before = ReadTree(root_);
    const std::filesystem::path map =
        root_ / "stereo" / folder / (kName + ".geometric.bin");
    const std::string imported = ReadText(map);
    UndoResult result = UndoImport(root_);
    EXPECT_EQ(result.num_images, 0);
    EXPECT_THAT(result.conflicts, testing::ElementsAre(Paths().depth.Path()));
    EXPECT_TRUE(ReadTree(root_) == before);
    result = UndoImport(root_, RestoreConflicts::kKeep);
    EXPECT_THAT(result.kept, testing::ElementsAre(Paths().depth.Path()));
    EXPECT_TRUE(ReadTree(root_) == before);
    // On demand it comes back, and the imported map is superseded.
    result = UndoImport(root_, RestoreConflicts::kOriginal);
    EXPECT_EQ(result.num_images, 1);
    EXPECT_EQ(ReadText(map), bytes);
    EXPECT_EQ(ReadText(GetSupersededFolder(root_) / folder /
                       (kName + ".geometric.bin")),
              imported);
    std::filesystem::remove_all(root_);
    MakeTestWorkspace(root_);
  }
}

TEST_F(ImportStoreTest, BrokenRecordsAreErrors) {
  Write(50.f);
  for (const char* text : {"", "{", "[]", "{\"depth_maps\": 3}"}) {
    WriteText(GetImportFolder(root_) / "records" / (kName + ".geometric.json"),
              text);
    ExpectError(ErrorCode::kCorrupt,
                {kName + ".geometric.json", "tsar_import/former"},
                [&] { UndoImport(root_); });
  }
}

}  // namespace
}  // namespace tsar
