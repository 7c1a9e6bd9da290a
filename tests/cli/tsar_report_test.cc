// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/write_back.h"

#include <filesystem>

#include "tests/cli/command_test.h"

namespace tsar {
namespace {

namespace fs = std::filesystem;

class TsarReportTest : public CommandTest<&RunTsarReport> {
 protected:
  void SetUp() override {
    MakeTestWorkspace(root_);
    WriteRefined(
        Workspace(root_, MapType::kGeometric), 1, MakeRefinedMaps(9.f), {});
  }
};

TEST_F(TsarReportTest, WritesThePageIntoTheWorkspace) {
  const Outcome outcome = Run({});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out,
            "Wrote a page about 1 image\nOpen " +
                (root_ / "report/index.html").string() + " in a browser\n");
  EXPECT_TRUE(fs::is_regular_file(root_ / "report/index.html"));
  ExpectFailure({}, "--overwrite 1");
  EXPECT_EQ(Run({"--overwrite", "1"}).exit_code, 0);
}

TEST_F(TsarReportTest, TakesThePhotometricMapsWhereOnlyTheyWereRefined) {
  const auto page = [&] {
    EXPECT_EQ(Run({"--overwrite", "1"}).exit_code, 0);
    return ReadText(root_ / "report/index.html");
  };
  const Workspace photometric(root_, MapType::kPhotometric);
  WriteRefined(photometric, 0, MakeRefinedMaps(9.f), {});
  EXPECT_THAT(page(), testing::HasSubstr("geometric maps"));
  Restore(root_);
  WriteRefined(photometric, 0, MakeRefinedMaps(9.f), {});
  EXPECT_THAT(page(), testing::HasSubstr("photometric maps"));
}

TEST_F(TsarReportTest, WrongInputIsOneLine) {
  ExpectFailure({"--input_type", "photometric"}, "run tsar_refine on it first");
  ExpectFailure({"--report_path", root_.string()}, "is no report");
  ExpectFailure({"--report_path", (root_ / "images").string()},
                "is in the folder images of a workspace");
  // Of any workspace, even through links.
  const fs::path other = folder_.Path() / "other";
  fs::create_directories(other / "images/left");
  fs::create_directories(other / "sparse");
  fs::create_directory_symlink(other / "sparse", folder_.Path() / "link");
  for (const fs::path& folder : {other / "images/left/page",
                                 other / "sparse",
                                 folder_.Path() / "link/page"}) {
    ExpectFailure({"--report_path", folder.string()}, "of a workspace");
  }
}

}  // namespace
}  // namespace tsar
