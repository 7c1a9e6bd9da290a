// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/result_files.h"

#include "tests/run/store/write_back_testing.h"

namespace tsar {
namespace {

class ChangedResultsTest : public WriteBackTest {
 protected:
  void SetUp() override {
    WriteBackTest::SetUp();
    for (const int image : {0, 1}) {
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
    // The same bytes of another time, as after copying.
    WriteText(*file.path, bytes);
    EXPECT_EQ(Warnings(), "");
  }
}

TEST_F(ChangedResultsTest, ManyAreOneLine) {
  std::filesystem::remove_all(root_ / "stereo/plane_maps");
  EXPECT_THAT(
      Warnings(),
      testing::AllOf(testing::HasSubstr("a.png.geometric.png and 1 more"),
                     testing::Not(testing::HasSubstr("left/b.png"))));
  // Nothing is missed of images that were not refined.
  WriteText(workspace().Paths(0, MapType::kGeometric).record, "no record");
  EXPECT_THAT(Warnings(), testing::HasSubstr("left/b.png.geometric.png: gone"));
}

}  // namespace
}  // namespace tsar
