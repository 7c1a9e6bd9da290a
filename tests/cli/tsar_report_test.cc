// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/write_back.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

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

TEST_F(TsarReportTest, RefusesOptionsOfThePageForAPictureAlone) {
  const std::string picture = (folder_.Path() / "comparison.png").string();
  for (const char* option : {"--before_path",
                             "--after_path",
                             "--ground_truth_path",
                             "--scans_path"}) {
    ExpectFailure({"--output_path", picture, option, "somewhere"},
                  Words{std::string(option) + " is for a page"});
  }
  ExpectFailure({"--output_path", picture, "--fuse", "default"},
                "--fuse is for a page");
  EXPECT_FALSE(fs::exists(picture));
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
  EXPECT_THAT(without.err,
              testing::AllOf(testing::HasSubstr("no --before_path: the page"),
                             testing::HasSubstr("--fuse default")));
  const Outcome both =
      Run({"--after_path", cloud, "--before_path", cloud, "--overwrite", "1"});
  EXPECT_EQ(both.exit_code, 0);
  EXPECT_THAT(both.err, testing::Not(testing::HasSubstr("before_path")));
}

TEST(TsarReportFuse, MakesTheCloudsThatAreNotGiven) {
  const TemporaryFolder folder;
  const fs::path root = folder.Path() / "dense";
  using Wall = SyntheticWorkspace;
  MakeSyntheticWorkspace(root);
  const auto fuse = [&](const std::string& name) {
    const std::string cloud = (folder.Path() / name).string();
    EXPECT_EQ(RunWith({"tsar_fuse",
                       "--workspace_path",
                       root.string(),
                       "--TsarFuse.preset",
                       "colmap",
                       "--output_path",
                       cloud})
                  .exit_code,
              0);
    return cloud;
  };
  const std::string before = fuse("before.ply");
  const Workspace workspace(root, MapType::kGeometric);
  for (int image = 0; image < 4; ++image) {
    WriteRefined(workspace,
                 image,
                 MakeRefinedMaps(Wall::kDepth, Wall::kWidth, Wall::kHeight),
                 {});
  }
  const std::string after = fuse("after.ply");
  const auto files = ReadTree(root);
  const fs::path page = folder.Path() / "page";
  const auto report = [&](const std::vector<std::string>& clouds) {
    std::vector<std::string> arguments = {"tsar_report",
                                          "--workspace_path",
                                          root.string(),
                                          "--report_path",
                                          page.string(),
                                          "--overwrite",
                                          "1"};
    arguments.insert(arguments.end(), clouds.begin(), clouds.end());
    return RunWith(arguments);
  };
  // The samples of the points before and after.
  const auto points = [&] {
    return std::pair(ReadText(page / "data/points_before.js"),
                     ReadText(page / "data/points_after.js"));
  };
  EXPECT_EQ(report({"--before_path", before, "--after_path", after}).exit_code,
            0);
  const auto given = points();
  EXPECT_NE(given.first.size(), given.second.size());
  for (const std::vector<std::string>& clouds : {std::vector<std::string>{},
                                                 {"--after_path", after},
                                                 {"--before_path", before}}) {
    std::vector<std::string> arguments = clouds;
    arguments.insert(arguments.end(), {"--fuse", "colmap"});
    const Outcome outcome = report(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, testing::Not(testing::HasSubstr("before_path")));
    EXPECT_TRUE(points() == given);
    EXPECT_THAT(
        ReadText(page / "data/report.js"),
        testing::AllOf(
            testing::HasSubstr("\"tsar_fuse --TsarFuse.preset colmap\""),
            testing::HasSubstr("\"from_clouds\": true"),
            testing::HasSubstr("\"before_from_maps\": false")));
    EXPECT_FALSE(fs::exists(page / "fused"));
  }
  EXPECT_TRUE(ReadTree(root) == files);
  const Outcome both = report(
      {"--before_path", before, "--after_path", after, "--fuse", "colmap"});
  EXPECT_EQ(both.exit_code, 1);
  EXPECT_THAT(both.err, testing::HasSubstr("--fuse makes the clouds"));
  EXPECT_TRUE(points() == given);
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
}

}  // namespace
}  // namespace tsar
