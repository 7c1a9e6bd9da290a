// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/result_files.h"

#include "tests/run/store/write_back_testing.h"

namespace tsar {
namespace {

class ChangedResultsTest : public WriteBackTest {
 protected:
  void SetUp() override {
    WriteBackTest::SetUp();
    for (const int image : {0, 1, 2}) {
      RefinedMaps maps = MakeRefinedMaps(42.f);
      maps.planes = Image<uint16_t>(maps.depth.Width(), maps.depth.Height());
      WriteRefined(workspace(), image, maps, Record());
    }
  }
  std::string Warnings(const std::vector<std::string>& names = {}) {
    testing::internal::CaptureStderr();
    WarnOfChangedResults(workspace(), names);
    return testing::internal::GetCapturedStderr();
  }
};

TEST_F(ChangedResultsTest, EachFileThatIsGoneOrAnotherIsTold) {
  EXPECT_EQ(Warnings(), "");
  const MapPaths paths = workspace().Paths(0, MapType::kGeometric);
  for (const ResultFile& file : ResultFiles(paths)) {
    if (!std::filesystem::exists(*file.path)) {
      continue;  // Of a refinement without sigmas.
    }
    const std::string bytes = ReadText(*file.path);
    const auto expect_told = [&] {
      EXPECT_THAT(Warnings(),
                  testing::AllOf(testing::HasSubstr(file.path->string()),
                                 testing::HasSubstr("run tsar_refine again")));
      EXPECT_EQ(Warnings({"none of these"}), "");
    };
    std::filesystem::remove(*file.path);
    expect_told();
    WriteText(*file.path, bytes + "x");
    expect_told();
    std::filesystem::remove(*file.path);
    std::filesystem::create_directory(file.path->Path());
    expect_told();
    std::filesystem::remove(*file.path);
    // The same bytes with another time, as after copying.
    WriteText(*file.path, bytes);
    EXPECT_EQ(Warnings(), "");
  }
}

TEST_F(ChangedResultsTest, ManyAreOneLine) {
  std::filesystem::remove_all(root_ / "stereo/plane_maps");
  EXPECT_THAT(
      Warnings(),
      testing::AllOf(testing::HasSubstr("a.png.geometric.png and 2 more"),
                     testing::Not(testing::HasSubstr("left/b.png"))));
  // Nothing is missing for images that were not refined.
  WriteText(workspace().Paths(0, MapType::kGeometric).record, "no record");
  EXPECT_THAT(Warnings(),
              testing::HasSubstr("left/b.png.geometric.png and 1 more: gone"));
}

// As left by a run that was stopped, and by users who move maps away.
TEST_F(ChangedResultsTest, WhatIsMixedOrLeftOutIsTold) {
  const MapPaths paths = workspace().Paths(0, MapType::kGeometric);
  const MapPaths others = workspace().Paths(1, MapType::kGeometric);
  const std::string depth = ReadText(others.depth);
  WriteText(others.depth, ReadText(paths.original_depth));
  EXPECT_THAT(Warnings(), testing::HasSubstr(others.depth.string() + ": gone"));
  std::filesystem::remove(others.depth);
  EXPECT_THAT(Warnings(), testing::HasSubstr(others.depth.string() + ": gone"));
  EXPECT_EQ(Warnings({"planes"}), "");
  WriteText(others.depth, depth);
  WriteRefined(workspace(), 1, MakeRefinedMaps(42.f), Record("others"));
  EXPECT_THAT(Warnings(), testing::HasSubstr("with different options"));
  KeepImage(workspace(), 1, Record());
  EXPECT_EQ(Warnings(), "");
  std::filesystem::remove(paths.record);
  EXPECT_THAT(Warnings(), testing::HasSubstr("1 of 2 images are refined"));
  std::filesystem::remove(paths.depth);
  EXPECT_THAT(Warnings(),
              testing::AllOf(testing::HasSubstr(paths.depth.string() +
                                                ": there is no such map"),
                             testing::Not(testing::HasSubstr("refined"))));
  // Stopped before the first image.
  Restore(root_);
  EXPECT_EQ(Warnings(), "");
  std::filesystem::create_directories(root_ / "stereo/tsar/evidence");
  EXPECT_THAT(Warnings(), testing::HasSubstr("0 of "));
}

}  // namespace
}  // namespace tsar
