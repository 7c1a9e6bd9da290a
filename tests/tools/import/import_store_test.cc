// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_store.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/originals.h"

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
    return root_ / "stereo/tsar_import" / "former" / folder /
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
  const RestoreResult result = UndoImport(root_);
  EXPECT_EQ(result.num_restored, 1);
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
  const RestoreResult result = UndoImport(root_);
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
    EXPECT_EQ(UndoImport(root_).num_restored, 0);
    EXPECT_TRUE(ReadTree(root_) == before);
  }
}

// By the rules of the originals of tsar_refine.
TEST_F(ImportStoreTest, UndoingLosesNothingThatOthersWrote) {
  WriteText(Paths().cost, ReadText(Paths().depth));
  for (const std::string folder : {"depth_maps", "normal_maps", "cost_maps"}) {
    for (const bool is_complete : {true, false}) {
      SCOPED_TRACE(folder);
      Write(50.f, true);
      Write(60.f, true);
      const std::filesystem::path map =
          root_ / "stereo" / folder / (kName + ".geometric.bin");
      const std::filesystem::path superseded =
          GetSupersededFolder(root_) / folder / (kName + ".geometric.bin");
      const std::string former = ReadText(Former(folder));
      std::string bytes = ReadText(map);
      is_complete ? void(bytes.back() ^= 1) : bytes.resize(20);
      WriteText(map, bytes);
      const RestoreResult result = UndoImport(root_);
      EXPECT_EQ(result.kept.size(), is_complete ? 1u : 0u);
      EXPECT_EQ(ReadText(map), is_complete ? bytes : former);
      EXPECT_EQ(ReadText(superseded), is_complete ? former : bytes);
      std::filesystem::remove_all(GetSupersededFolder(root_).Path());
      WriteText(map, former);
    }
  }
}

// A broken one counts for nothing.
TEST_F(ImportStoreTest, UndoesImportsWithoutTheirRecords) {
  const std::string depth = ReadText(Paths().depth);
  Write(50.f);
  const std::string imported = ReadText(Paths().depth);
  WriteText(root_ / "stereo/tsar_import/records" / (kName + ".geometric.json"),
            "{");
  EXPECT_EQ(UndoImport(root_).superseded.size(), 2u);
  EXPECT_EQ(ReadText(Paths().depth), depth);
  EXPECT_EQ(ReadText(GetSupersededFolder(root_) / "depth_maps" /
                     (kName + ".geometric.bin")),
            imported);
}

}  // namespace
}  // namespace tsar
