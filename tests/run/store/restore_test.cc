// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/restore.h"

#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/output_workspace.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/workspace_lock.h"

#include <chrono>
#include <fstream>
#include <functional>
#include <map>

#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"
#include "tests/support/write_refined.h"

namespace tsar {
namespace {

constexpr MapType kType = MapType::kGeometric;

// What somebody makes of the maps that were refined.
enum class Fate { kLeft, kMasked, kCut, kAnew, kDeleted };

class RestoreTest : public testing::Test {
 protected:
  void SetUp() override { Begin(); }

  // A workspace with one refined image.
  void Begin() {
    std::filesystem::remove_all(root_);
    MakeTestWorkspace(root_);
    original_depth_ = ReadText(Paths().depth);
    original_normal_ = ReadText(Paths().normal);
    Refine();
  }
  void Refine() {
    ImageRecord record;
    record.options_hash = "options";
    WriteRefined(Workspace(root_, kType), 0, Refined(), record);
  }
  // Values that differ from each other and from the original's.
  static RefinedMaps Refined() {
    RefinedMaps maps = MakeRefinedMaps(42.f);
    for (int i = 0; i < 12; ++i) {
      maps.depth.Data()[i] += 0.25f * static_cast<float>(i);
      maps.normal.Data()[i].x = 0.01f * static_cast<float>(i + 1);
    }
    return maps;
  }
  MapPaths Paths() const { return GetMapPaths(root_, "a.png", kType); }
  std::filesystem::path Superseded(const std::string& kind) const {
    return GetSupersededFolder(root_) / kind / "a.png.geometric.bin";
  }

  // Another time than that of the refinement.
  static void Write(const std::filesystem::path& path,
                    const std::string& bytes) {
    const auto time = std::filesystem::last_write_time(path);
    WriteText(path, bytes);
    std::filesystem::last_write_time(path, time + std::chrono::hours(1));
  }
  static void Suffer(Fate fate, const std::filesystem::path& path) {
    std::string bytes = ReadText(path);
    const size_t header = bytes.rfind('&') + 1;
    switch (fate) {
      case Fate::kLeft:
        return;
      case Fate::kMasked:
        // Half of the pixels.
        std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(header),
                  bytes.begin() + static_cast<std::ptrdiff_t>(
                                      header + (bytes.size() - header) / 2),
                  '\0');
        break;
      case Fate::kCut:
        bytes.resize(bytes.size() / 2);
        break;
      case Fate::kAnew:
        for (size_t i = header; i < bytes.size(); i += sizeof(float)) {
          const float value = 9.f + 0.1f * static_cast<float>(i);
          std::memcpy(&bytes[i], &value, sizeof(value));
        }
        break;
      case Fate::kDeleted:
        std::filesystem::remove(path);
        return;
    }
    Write(path, bytes);
  }

  bool HasOriginals() const {
    return ReadText(Paths().depth) == original_depth_ &&
           ReadText(Paths().normal) == original_normal_;
  }
  bool KeepsOriginals() const {
    return ReadText(Paths().original_depth) == original_depth_ &&
           ReadText(Paths().original_normal) == original_normal_;
  }

  TemporaryFolder folder_;
  std::filesystem::path root_ = folder_.Path() / "dense";
  std::string original_depth_;
  std::string original_normal_;
};

// Whatever happened to the refined maps: no original is lost, nor what somebody
// else wrote, and depth and normals are of one source.
TEST_F(RestoreTest, LosesNothingWhateverBecameOfTheMaps) {
  const std::vector<Fate> fates = {
      Fate::kLeft, Fate::kMasked, Fate::kCut, Fate::kAnew, Fate::kDeleted};
  for (const Fate depth : fates) {
    for (const Fate normal : fates) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(depth) << " and "
                                      << static_cast<int>(normal));
      Begin();
      Suffer(depth, Paths().depth);
      Suffer(normal, Paths().normal);
      const bool has_depth = depth != Fate::kDeleted;
      const bool has_normal = normal != Fate::kDeleted;
      const std::string depth_text = has_depth ? ReadText(Paths().depth) : "";
      const std::string normal_text =
          has_normal ? ReadText(Paths().normal) : "";
      const RestoreResult result = Restore(root_);

      if (depth == Fate::kAnew && normal == Fate::kAnew) {
        EXPECT_EQ(result.num_restored, 0);
        EXPECT_THAT(result.kept, testing::ElementsAre(Paths().depth.Path()));
        EXPECT_EQ(ReadText(Paths().depth), depth_text);
        EXPECT_EQ(ReadText(Paths().normal), normal_text);
        EXPECT_TRUE(KeepsOriginals());
        // They are the originals of the next refinement.
        const OriginalMaps originals = FindOriginals(Paths());
        EXPECT_EQ(originals.depth.state, OriginalState::kReplaced);
        EXPECT_EQ(originals.depth.path, Paths().depth.Path());
        EXPECT_EQ(originals.normal.path, Paths().normal.Path());
      } else if (depth == Fate::kAnew || normal == Fate::kAnew) {
        EXPECT_EQ(result.num_restored, 0);
        EXPECT_THAT(result.conflicts,
                    testing::ElementsAre(Paths().depth.Path()));
        EXPECT_EQ(std::filesystem::exists(Paths().depth), has_depth);
        EXPECT_EQ(std::filesystem::exists(Paths().normal), has_normal);
        EXPECT_TRUE(!has_depth || ReadText(Paths().depth) == depth_text);
        EXPECT_TRUE(!has_normal || ReadText(Paths().normal) == normal_text);
        EXPECT_TRUE(KeepsOriginals());
        EXPECT_TRUE(std::filesystem::exists(Paths().confidence));
        ExpectError(ErrorCode::kMismatch,
                    {Paths().depth.string(), "restore_conflicts"},
                    [&] { FindOriginals(Paths()); });
      } else {
        EXPECT_EQ(result.num_restored, 1);
        EXPECT_TRUE(HasOriginals());
        EXPECT_FALSE(std::filesystem::exists(Paths().original_depth));
        const auto is_superseded = [](Fate fate) {
          return fate == Fate::kMasked || fate == Fate::kCut;
        };
        EXPECT_EQ(result.superseded.size(),
                  static_cast<size_t>(is_superseded(depth)) +
                      static_cast<size_t>(is_superseded(normal)));
        if (is_superseded(depth)) {
          EXPECT_EQ(ReadText(Superseded("depth_maps")), depth_text);
        }
        if (is_superseded(normal)) {
          EXPECT_EQ(ReadText(Superseded("normal_maps")), normal_text);
        }
        ExpectError(ErrorCode::kNotFound, {"nothing to restore"}, [&] {
          Restore(root_);
        });
      }
    }
  }
}

// An original that is kept and is not what was kept: nothing is put in the
// place of the refined map, which is whole, until the user decides.
TEST_F(RestoreTest, OriginalsThatWereChangedAreAConflict) {
  const std::map<std::string, std::function<void(std::string*)>> changes = {
      {"emptied", [](std::string* bytes) { bytes->clear(); }},
      {"cut", [](std::string* bytes) { bytes->resize(bytes->size() / 2); }},
      {"altered", [](std::string* bytes) { bytes->back() ^= 1; }},
      {"another image's",
       [this](std::string* bytes) {
         *bytes = ReadText(GetMapPaths(root_, "c.png", kType).depth);
       }},
  };
  for (const auto& [name, change] : changes) {
    SCOPED_TRACE(name);
    Begin();
    const std::string refined = ReadText(Paths().depth);
    std::string bytes = original_depth_;
    change(&bytes);
    ASSERT_NE(bytes, original_depth_);
    WriteText(Paths().original_depth, bytes);
    ExpectError(ErrorCode::kMismatch,
                {Paths().original_depth.string(), "restore_conflicts"},
                [&] { FindOriginals(Paths(), Scrutiny::kTimeAndSamples); });
    RestoreResult result = Restore(root_);
    EXPECT_EQ(result.num_restored, 0);
    EXPECT_THAT(result.conflicts, testing::ElementsAre(Paths().depth.Path()));
    EXPECT_EQ(ReadText(Paths().depth), refined);
    EXPECT_TRUE(std::filesystem::exists(Paths().record));
    EXPECT_TRUE(std::filesystem::exists(Paths().confidence));
    // On demand it comes back, and the refined map is superseded.
    result = Restore(root_, RestoreConflicts::kOriginal);
    EXPECT_EQ(result.num_restored, 1);
    EXPECT_EQ(ReadText(Paths().depth), bytes);
    EXPECT_EQ(ReadText(Superseded("depth_maps")), refined);
  }
}

// Nothing is put back where what belongs to it cannot be removed.
TEST_F(RestoreTest, RefusesFoldersUnderTheNamesOfResults) {
  std::filesystem::remove(Paths().sigma);
  WriteText(Paths().sigma.Path() / "inside", "");
  const auto before = ReadTree(root_);
  ExpectError(ErrorCode::kIo,
              {Paths().sigma.string(), "move the folder of this name away"},
              [&] { Restore(root_); });
  EXPECT_TRUE(ReadTree(root_) == before);
  std::filesystem::remove_all(Paths().sigma);
  EXPECT_EQ(Restore(root_).num_restored, 1);
}

// Without a record there is no telling what was kept, but for what is no map.
TEST_F(RestoreTest, OriginalsWithoutARecordAreCompleteMaps) {
  std::filesystem::remove(Paths().record);
  WriteText(Paths().original_depth, original_depth_.substr(0, 20));
  const std::string refined = ReadText(Paths().depth);
  EXPECT_EQ(Restore(root_).conflicts.size(), 1u);
  EXPECT_EQ(ReadText(Paths().depth), refined);
}

TEST_F(RestoreTest, ARecordOfAnotherImageIsNone) {
  WriteRefined(Workspace(root_, kType), 2, MakeRefinedMaps(7.f), {});
  WriteText(Paths().record,
            ReadText(GetMapPaths(root_, "c.png", kType).record));
  ExpectError(ErrorCode::kCorrupt,
              {Paths().record.string(), "another image"},
              [&] { FindOriginals(Paths()); });
  EXPECT_EQ(Restore(root_).num_restored, 2);
  EXPECT_TRUE(HasOriginals());
}

// By it, the refined maps are of another program.
TEST_F(RestoreTest, ARecordOfAnotherSceneIsAConflict) {
  const std::filesystem::path other = folder_.Path() / "other";
  MakeTestWorkspace(other);
  WriteTestMaps(other, "a.png", kType, 9.f);
  WriteRefined(Workspace(other, kType), 0, MakeRefinedMaps(7.f), {});
  WriteText(Paths().record,
            ReadText(GetMapPaths(other, "a.png", kType).record));
  const std::string refined = ReadText(Paths().depth);
  ExpectError(ErrorCode::kMismatch,
              {Paths().original_depth.string(), "restore_conflicts"},
              [&] { FindOriginals(Paths()); });
  EXPECT_THAT(Restore(root_).conflicts,
              testing::ElementsAre(Paths().depth.Path()));
  EXPECT_EQ(ReadText(Paths().depth), refined);
  EXPECT_TRUE(KeepsOriginals());
}

TEST_F(RestoreTest, ConflictsAreDecidedByTheUser) {
  for (const Fate normal : {Fate::kLeft, Fate::kAnew}) {
    Begin();
    Suffer(Fate::kAnew, Paths().depth);
    Suffer(normal, Paths().normal);
    const std::string depth = ReadText(Paths().depth);
    RestoreResult result = Restore(root_, RestoreConflicts::kKeep);
    EXPECT_THAT(result.kept, testing::ElementsAre(Paths().depth.Path()));
    EXPECT_EQ(ReadText(Paths().depth), depth);
    EXPECT_TRUE(KeepsOriginals());
    EXPECT_FALSE(std::filesystem::exists(Paths().confidence));
    // A later call may decide otherwise.
    result = Restore(root_, RestoreConflicts::kOriginal);
    EXPECT_EQ(result.num_restored, 1);
    EXPECT_TRUE(HasOriginals());
    EXPECT_EQ(ReadText(Superseded("depth_maps")), depth);
  }
}

TEST_F(RestoreTest, NothingSupersededIsEverReplaced) {
  for (int i = 1; i <= 3; ++i) {
    if (i > 1) {
      Refine();
    }
    std::string bytes = ReadText(Paths().depth);
    bytes[bytes.size() - 4 * static_cast<size_t>(i)] ^= 1;
    std::fill(bytes.end() - 4 * (i + 1), bytes.end(), '\0');
    Write(Paths().depth, bytes);
    const RestoreResult result = Restore(root_);
    ASSERT_EQ(result.superseded.size(), 1u);
    EXPECT_EQ(ReadText(result.superseded[0]), bytes);
  }
  EXPECT_TRUE(HasOriginals());
  const std::filesystem::directory_iterator files(
      Superseded("depth_maps").parent_path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 3);
}

TEST_F(RestoreTest, EditedMapsAreNoOriginals) {
  Suffer(Fate::kMasked, Paths().depth);
  ExpectError(ErrorCode::kMismatch,
              {Paths().depth.string(), "edited", "restore 1"},
              [&] { Workspace(root_, kType).ReadOriginalMaps(0, kType); });
  EXPECT_TRUE(KeepsOriginals());
}

TEST_F(RestoreTest, AnOriginalThatANewerOneReplacesIsKept) {
  Suffer(Fate::kAnew, Paths().depth);
  Suffer(Fate::kAnew, Paths().normal);
  const std::string newer = ReadText(Paths().depth);
  Refine();
  EXPECT_EQ(ReadText(Superseded("depth_maps")), original_depth_);
  EXPECT_EQ(ReadText(Superseded("normal_maps")), original_normal_);
  EXPECT_EQ(Restore(root_).num_restored, 1);
  EXPECT_EQ(ReadText(Paths().depth), newer);
  EXPECT_EQ(ReadText(Superseded("depth_maps")), original_depth_);
}

// Of the same time as the refined one: damaged by the disk, perhaps.
TEST_F(RestoreTest, OtherValuesOfTheSameTimeAreAConflict) {
  for (const ContainedPath& path : {Paths().depth, Paths().normal}) {
    const auto time = std::filesystem::last_write_time(path);
    Suffer(Fate::kAnew, path);
    std::filesystem::last_write_time(path, time);
  }
  EXPECT_EQ(Restore(root_).conflicts.size(), 1u);
  EXPECT_TRUE(KeepsOriginals());
}

TEST_F(RestoreTest, OriginalsThatAreGoneLeaveTraces) {
  std::filesystem::remove_all(GetTsarFolder(root_).Path());
  ExpectError(ErrorCode::kMismatch,
              {Paths().depth.string(), Paths().confidence.string()},
              [&] { RequireNoStrayResults(Paths()); });
  RemoveResults(Paths());
  RequireNoStrayResults(Paths());
  // Each of them tells it alone, and lies in one of the folders to delete.
  const MapPaths paths = Paths();
  for (const ResultFile& result : ResultFiles(paths)) {
    std::filesystem::create_directories(result.path->Path().parent_path());
    WriteText(*result.path, "of a refinement");
    ExpectError(ErrorCode::kMismatch,
                {result.path->string(),
                 "stereo/confidence_maps, stereo/sigma_maps, "
                 "stereo/provenance_maps and stereo/plane_maps"},
                [&] { RequireNoStrayResults(paths); });
    for (const char* folder : kResultFolders) {
      std::filesystem::remove_all(root_ / "stereo" / folder);
    }
    RequireNoStrayResults(paths);
  }
}

TEST_F(RestoreTest, LinksOfOutputWorkspacesLeadToTheOriginalsAgain) {
  const std::filesystem::path output = folder_.Path() / "output";
  CreateOutputWorkspace(Workspace(root_, kType), output, kType);
  const MapPaths paths = GetMapPaths(output, "a.png", kType);
  EXPECT_EQ(ReadText(paths.depth), original_depth_);
  // Its marker names another input: not one of this workspace.
  const std::filesystem::path other = folder_.Path() / "other";
  std::filesystem::copy(output,
                        other,
                        std::filesystem::copy_options::recursive |
                            std::filesystem::copy_options::copy_symlinks);
  WriteText(other / "stereo/tsar/output_of.json", R"({"input": "/nowhere"})");
  const std::string note = R"({"output": ")" + other.string() + "\"}";
  WriteText(root_ / "stereo/tsar/outputs/other.json", note);
  const RestoreResult result = Restore(root_);
  EXPECT_THAT(result.relinked, testing::ElementsAre(output));
  EXPECT_EQ(ReadText(paths.depth), original_depth_);
  EXPECT_EQ(ReadText(paths.normal), original_normal_);
  EXPECT_FALSE(
      std::filesystem::exists(GetMapPaths(other, "a.png", kType).depth.Path()));
  EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/tsar"));
}

}  // namespace
}  // namespace tsar
