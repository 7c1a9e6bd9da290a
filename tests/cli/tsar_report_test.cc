// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/write_back.h"

#include <filesystem>

#include "tests/cli/command_test.h"
#include "tests/support/write_refined.h"

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
  const auto type_of_page = [&] {
    EXPECT_EQ(Run({"--overwrite", "1"}).exit_code, 0);
    const std::string data = ReadText(root_ / "report/data/report.js");
    return data.substr(data.find("\"type\""), 20);
  };
  const Workspace photometric(root_, MapType::kPhotometric);
  WriteRefined(photometric, 0, MakeRefinedMaps(9.f), {});
  EXPECT_THAT(type_of_page(), testing::HasSubstr("geometric"));
  Restore(root_);
  WriteRefined(photometric, 0, MakeRefinedMaps(9.f), {});
  EXPECT_THAT(type_of_page(), testing::HasSubstr("photometric"));
}

TEST_F(TsarReportTest, DrawsThePictureAloneOrWithAPage) {
  const fs::path picture = folder_.Path() / "comparison.png";
  const Outcome alone = Run({"--output_path", picture.string()});
  EXPECT_EQ(alone.exit_code, 0) << alone.err;
  EXPECT_EQ(alone.out, "Wrote " + picture.string() + "\n");
  EXPECT_TRUE(fs::is_regular_file(picture));
  EXPECT_FALSE(fs::exists(root_ / "report"));
  const fs::path page = folder_.Path() / "page";
  fs::remove(picture);
  EXPECT_EQ(
      Run({"--output_path", picture.string(), "--report_path", page.string()})
          .exit_code,
      0);
  EXPECT_TRUE(fs::is_regular_file(picture));
  EXPECT_TRUE(fs::is_regular_file(page / "index.html"));
}

TEST_F(TsarReportTest, ReplacesAPictureOnlyWhenAsked) {
  const fs::path picture = folder_.Path() / "comparison.png";
  WriteText(picture, "years of work");
  ExpectFailure({"--output_path", picture.string()}, "--overwrite 1");
  EXPECT_EQ(
      Run({"--output_path", picture.string(), "--overwrite", "1"}).exit_code,
      0);
  EXPECT_NE(ReadText(picture), "years of work");
  for (const char* path :
       {"images/a.png", "images/new.png", "sparse/new.png", "stereo/new.png"}) {
    ExpectFailure(
        {"--output_path", (root_ / path).string(), "--overwrite", "1"},
        "choose another --output_path");
  }
}

TEST_F(TsarReportTest, SaysThatTheCloudBeforeIsMissing) {
  const std::string cloud = (folder_.Path() / "after.ply").string();
  WriteText(cloud,
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
            "property float y\nproperty float z\nend_header\n1 2 3\n");
  const Outcome without = Run({"--after_path", cloud});
  EXPECT_EQ(without.exit_code, 0);
  EXPECT_THAT(without.err, testing::HasSubstr("no --before_path: the page"));
  const Outcome both =
      Run({"--after_path", cloud, "--before_path", cloud, "--overwrite", "1"});
  EXPECT_EQ(both.exit_code, 0);
  EXPECT_THAT(both.err, testing::Not(testing::HasSubstr("before_path")));
}

TEST_F(TsarReportTest, WrongInputIsOneLine) {
  ExpectFailure({"--input_type", "photometric"}, "run tsar_refine on it first");
  ExpectFailure({"--input_type", "photometric", "--output_path", "x.png"},
                "run tsar_refine on it first");
  ExpectFailure({"--report_path", root_.string()}, "is no report");
  ExpectFailure({"--report_path", (root_ / "images").string()},
                "is in the folder images of a workspace");
  ExpectFailure({"--before_path", "a.ply"}, "--after_path");
  ExpectFailure({"--before_path", "a.ply", "--after_path", "b.ply"},
                "a.ply: there is no such file");
  ExpectFailure({"--tolerances", "0.1,0.02"}, "--tolerances");
  ExpectFailure({"--debug_path", "nowhere"}, "nowhere");
}

}  // namespace
}  // namespace tsar
