// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/result_files.h"

#include <chrono>
#include <optional>

#include "tests/run/store/write_back_testing.h"
#include "tests/support/synthetic_workspace.h"
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

// The depth maps that can exist.
constexpr const char* kNone = "none";
constexpr const char* kOriginal = "the original";
constexpr const char* kRefined = "the refined one";
constexpr const char* kOther = "another one";

// A change to the files of a refined image's depth map, and the expected
// results.
struct Case {
  const char* name;
  std::function<void(const MapPaths& paths)> change;
  // Contents after restoring: of the map, and of the superseded file.
  const char* restored;
  const char* superseded = kNone;
  // Contents after refining again: of the kept original, and of the superseded
  // file; none if it is refused with the text.
  const char* kept = kNone;
  const char* superseded_by_refining = kNone;
  const char* refusal = "";
  bool is_lost = false;
};

// With a time of its own, since the clock may not have advanced.
void WriteAnew(const std::filesystem::path& path, const std::string& bytes) {
  const auto time = std::filesystem::exists(path)
                        ? std::filesystem::last_write_time(path)
                        : std::filesystem::file_time_type::clock::now();
  WriteText(path, bytes);
  std::filesystem::last_write_time(path, time + std::chrono::hours(1));
}

std::string OtherMap() {
  return "4&3&1&" + std::string(4 * 3 * sizeof(float), '\1');
}

const std::vector<Case>& Cases() {
  static const std::vector<Case> cases = {
      {"nothing", [](const MapPaths&) {}, kOriginal, kNone, kOriginal},
      {"the map is written anew",
       [](const MapPaths& p) { WriteAnew(p.depth, OtherMap()); },
       kOther,
       kOriginal,
       kOther,
       kOriginal},
      {"the map is written anew and has the time of the one that is kept",
       [](const MapPaths& p) {
         WriteText(p.depth, OtherMap());
         std::filesystem::last_write_time(
             p.depth.Path(),
             std::filesystem::last_write_time(p.original_depth.Path()));
       },
       kOther,
       kOriginal,
       kOther,
       kOriginal},
      {"half of the map is masked",
       [](const MapPaths& p) {
         std::string bytes = ReadText(p.depth);
         bytes.replace(6, 24, std::string(24, '\0'));
         WriteAnew(p.depth, bytes);
       },
       kOther,
       kOriginal,
       kOther,
       kOriginal},
      {"the map is cut off",
       [](const MapPaths& p) {
         WriteAnew(p.depth, ReadText(p.depth).substr(0, 20));
       },
       kOriginal,
       kOther,
       kOriginal},
      {"the map is emptied",
       [](const MapPaths& p) { WriteAnew(p.depth, ""); },
       kOriginal,
       kOther,
       kOriginal},
      {"the map is deleted",
       [](const MapPaths& p) { std::filesystem::remove(p.depth); },
       kOriginal,
       kNone,
       kOriginal},
      {"the map is copied and gets another time",
       [](const MapPaths& p) { WriteAnew(p.depth, ReadText(p.depth)); },
       kOriginal,
       kNone,
       kOriginal},
      {"the original is put back by hand",
       [](const MapPaths& p) {
         std::filesystem::rename(p.original_depth, p.depth);
       },
       kOriginal,
       kNone,
       kOriginal},
      {"the record is deleted",
       [](const MapPaths& p) { std::filesystem::remove(p.record); },
       kOriginal,
       kRefined,
       kNone,
       kNone,
       "nothing tells whether this map is an original"},
      {"the record is damaged",
       [](const MapPaths& p) { WriteText(p.record, "{"); },
       kOriginal,
       kRefined,
       kNone,
       kNone,
       "not a record"},
      {"the kept original is deleted",
       [](const MapPaths& p) { std::filesystem::remove(p.original_depth); },
       kRefined,
       kNone,
       kNone,
       kNone,
       "its original",
       true},
      {"the kept original is cut off",
       [](const MapPaths& p) {
         WriteText(p.original_depth, ReadText(p.original_depth).substr(0, 9));
       },
       kRefined,
       kNone,
       kNone,
       kNone,
       "its original",
       true},
      {"the kept original is deleted, and the map written anew",
       [](const MapPaths& p) {
         std::filesystem::remove(p.original_depth);
         WriteAnew(p.depth, OtherMap());
       },
       kOther,
       kNone,
       kOther},
  };
  return cases;
}

class OwnershipTest : public WriteBackTest,
                      public testing::WithParamInterface<Case> {
 protected:
  void SetUp() override {
    WriteBackTest::SetUp();
    original_ = ReadText(paths_.depth);
    WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
    refined_ = ReadText(paths_.depth);
    GetParam().change(paths_);
    other_ = std::filesystem::exists(paths_.depth) ? ReadText(paths_.depth)
                                                   : std::string();
  }
  std::string Which(const std::filesystem::path& path) const {
    if (!std::filesystem::exists(path)) {
      return kNone;
    }
    const std::string bytes = ReadText(path);
    return bytes == original_  ? kOriginal
           : bytes == refined_ ? kRefined
           : bytes == other_   ? kOther
                               : "no known map";
  }
  std::filesystem::path Superseded() const {
    return GetSupersededFolder(root_) / "depth_maps" / "a.png.geometric.bin";
  }

  MapPaths paths_ = GetMapPaths(root_, "a.png", MapType::kGeometric);
  std::string original_;
  std::string refined_;
  std::string other_;
};

TEST_P(OwnershipTest, Restore) {
  const RestoreResult result = Restore(root_);
  EXPECT_EQ(Which(paths_.depth), GetParam().restored);
  EXPECT_EQ(Which(Superseded()), GetParam().superseded);
  EXPECT_EQ(result.lost.size(), GetParam().is_lost ? 1u : 0u);
  // If the original is lost, nothing else changes.
  EXPECT_EQ(std::filesystem::exists(paths_.record), GetParam().is_lost);
  EXPECT_EQ(std::filesystem::exists(paths_.confidence), GetParam().is_lost);
  if (!GetParam().is_lost) {
    ExpectError(
        ErrorCode::kNotFound, {"nothing to restore"}, [&] { Restore(root_); });
  }
}

TEST_P(OwnershipTest, RefineAgain) {
  const auto refine = [&] {
    WriteRefined(workspace(), 0, MakeRefinedMaps(43.f), Record());
  };
  if (GetParam().refusal[0] != '\0') {
    const auto before = ReadTree(root_);
    try {
      refine();
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(GetParam().refusal));
    }
    EXPECT_EQ(ReadTree(root_), before);
    return;
  }
  refine();
  EXPECT_EQ(Which(paths_.original_depth), GetParam().kept);
  EXPECT_EQ(Which(Superseded()), GetParam().superseded_by_refining);
  EXPECT_EQ(CurrentDepth(0), 43.f);
  EXPECT_TRUE(Restore(root_).lost.empty());
  EXPECT_EQ(Which(paths_.depth), GetParam().kept);
}

// An image that can no longer be refined gets its original back.
TEST_P(OwnershipTest, Keep) {
  if (GetParam().refusal[0] == '\0') {
    KeepImage(workspace(), 0, Record());
    EXPECT_EQ(Which(paths_.depth), GetParam().kept);
    EXPECT_FALSE(std::filesystem::exists(paths_.original_depth));
    EXPECT_FALSE(std::filesystem::exists(paths_.confidence));
    EXPECT_EQ(ReadRecord(paths_.record)->status, ImageStatus::kKept);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, OwnershipTest, testing::ValuesIn(Cases()), [](const auto& info) {
      std::string name = info.param.name;
      std::erase_if(name, [](char c) { return std::isalnum(c) == 0; });
      return name;
    });

TEST_F(WriteBackTest, NothingSupersededIsEverReplaced) {
  const MapPaths paths = workspace().Paths(0, MapType::kGeometric);
  const std::filesystem::path folder =
      GetSupersededFolder(root_) / "depth_maps";
  for (int i = 1; i <= 3; ++i) {
    WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
    const std::string bytes = "cut off " + std::to_string(i);
    WriteAnew(paths.depth, bytes);
    const RestoreResult result = Restore(root_);
    ASSERT_EQ(result.superseded.size(), 1u);
    EXPECT_EQ(ReadText(result.superseded[0]), bytes);
  }
  EXPECT_EQ(CurrentDepth(0), 2.f);
  const std::filesystem::directory_iterator files(folder);
  EXPECT_EQ(std::distance(begin(files), end(files)), 3);
}

// Nothing is put back where what belongs to it cannot be removed, or where what
// is kept is no file.
TEST_F(WriteBackTest, RestoreChecksAllBeforeTheFirstChange) {
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
  const MapPaths paths = workspace().Paths(0, MapType::kGeometric);
  const std::filesystem::path link = paths.original_depth.string() + ".bin";
  const std::vector<std::pair<std::filesystem::path, std::function<void()>>>
      obstacles = {
          {paths.sigma, [&] { WriteText(paths.sigma.Path() / "inside", ""); }},
          {link,
           [&] { std::filesystem::create_symlink(paths.depth.Path(), link); }}};
  for (const auto& [path, make] : obstacles) {
    make();
    const auto before = ReadTree(root_);
    try {
      Restore(root_);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(path.string()));
    }
    EXPECT_EQ(ReadTree(root_), before);
    std::filesystem::remove_all(path);
  }
  EXPECT_EQ(Restore(root_).num_restored, 1);
}

TEST_F(WriteBackTest, RestoreGivesBackTheSameBytesForAllTypes) {
  const auto clean = ReadTree(root_);
  const Workspace photometric(root_, MapType::kPhotometric);
  for (int image = 0; image < 3; ++image) {
    WriteRefined(workspace(), image, MakeRefinedMaps(42.f), Record());
    WriteRefined(photometric, image, MakeRefinedMaps(43.f), Record());
  }
  WriteText(root_ / "stereo/tsar/manifest.json", "{}");
  // Left behind by killed programs.
  for (const char* folder : {"depth_maps", "plane_maps/left", "tsar/records"}) {
    WriteText(root_ / "stereo" / folder / "a.jpg.geometric.bin.tsar_tmp",
              "half");
  }
  EXPECT_EQ(Restore(root_).num_restored, 6);
  EXPECT_EQ(ReadTree(root_), clean);
  // What is not this program's stays.
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
  const std::filesystem::path mine[] = {
      root_ / "stereo/confidence_maps/mine.bin",
      root_ / "stereo/depth_maps/mine.tsar_tmp",
      root_ / "stereo/confidence_maps/folder.tsar_tmp/mine.bin"};
  for (const std::filesystem::path& path : mine) {
    WriteText(path, "mine");
  }
  Restore(root_);
  for (const std::filesystem::path& path : mine) {
    EXPECT_EQ(ReadText(path), "mine");
  }
}

// Refined maps without stereo/tsar are no originals; each result file alone
// shows that, and lies in one of the folders to delete.
TEST_F(WriteBackTest, RefinedMapsWithoutTheirOriginalsLeaveTraces) {
  const MapPaths paths = workspace().Paths(0, MapType::kGeometric);
  for (const ResultFile& result : ResultFiles(paths)) {
    RequireNoStrayResults(paths);
    WriteText(*result.path, "of a refinement");
    ExpectError(ErrorCode::kMismatch,
                {paths.depth.string(),
                 result.path->string(),
                 "stereo/confidence_maps, stereo/sigma_maps, "
                 "stereo/provenance_maps and stereo/plane_maps"},
                [&] { RequireNoStrayResults(paths); });
    std::filesystem::remove(*result.path);
  }
}

TEST_F(WriteBackTest, RefusesBrokenRecords) {
  const MapPaths paths = workspace().Paths(0, MapType::kGeometric);
  WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
  const auto good = nlohmann::json::parse(ReadText(paths.record));
  std::vector<std::string> texts = {"", "{", "[]", "{}", "null"};
  for (const auto& [key, value] : good.items()) {
    nlohmann::json bad = good;
    bad[key] = 1.5;
    texts.push_back(bad.dump());
    bad.erase(key);
    texts.push_back(bad.dump());
  }
  for (const char* files : {R"({"depth": []})",
                            R"({"depth": "1@2"})",
                            R"({"depth": ["1@"]})",
                            R"({"depth": ["1@2#12"]})"}) {
    nlohmann::json bad = good;
    bad["files"] = nlohmann::json::parse(files);
    texts.push_back(bad.dump());
  }
  for (const std::string& text : texts) {
    SCOPED_TRACE(text);
    WriteText(paths.record, text);
    ExpectError(ErrorCode::kCorrupt, {paths.record.string(), "restore 1"}, [&] {
      ReadRecord(paths.record);
    });
  }
}

}  // namespace
}  // namespace tsar
