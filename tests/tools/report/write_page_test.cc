// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/write_page.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/run/store/write_back.h"
#include "colmap_tsar/tools/report/colors.h"
#include "colmap_tsar/tools/report/page_text.h"

#include <algorithm>
#include <sstream>

#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"
#include "tests/support/write_refined.h"
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// Of the three images, the first two are refined and the third is kept.
class WritePageTest : public testing::Test {
 protected:
  void SetUp() override {
    MakeTestWorkspace(root_);
    const Workspace workspace(root_, MapType::kGeometric);
    ImageRecord record;
    record.seconds = {{"matching", 1.5}};
    record.note = "depth prior not used: it has no depths";
    RefinedMaps maps = MakeRefinedMaps(9.f);
    WriteRefined(workspace, 0, maps, record);
    maps.depth(0, 0) = 0.f;
    maps.provenance(0, 0) = 0;
    maps.provenance(1, 0) = 1;
    maps.sigma = Image<uint16_t>(4, 3, ToPositiveHalf(0.045f));
    WriteRefined(workspace, 1, maps, record);
    record.note = "seen by nobody";
    KeepImage(workspace, 2, record);
    options_.report_path = root_ / "report";
  }

  int Write() const {
    std::ostringstream out;
    Progress progress(out, false);
    Workspace workspace(root_, MapType::kGeometric);
    workspace.UsePriors(prior_path_, PriorType::kAuto);
    return WritePage(workspace, options_, progress, [] { return false; });
  }

  nlohmann::json Data() const {
    const std::string script =
        ReadText(options_.report_path / "data/report.js");
    const size_t begin = script.find('{');
    return nlohmann::json::parse(
        script.substr(begin, script.rfind('}') + 1 - begin));
  }

  void ExpectFailure(ErrorCode code, const std::vector<std::string>& texts) {
    const auto before = ReadTree(root_);
    ExpectError(code, texts, [&] { Write(); });
    EXPECT_TRUE(ReadTree(root_) == before);
  }

  TemporaryFolder folder_;
  const fs::path root_ = folder_.Path() / "dense <&>";
  PageOptions options_;
  fs::path prior_path_;
};

TEST_F(WritePageTest, CountsAndNamesWhatIsThere) {
  EXPECT_EQ(Write(), 2);
  const nlohmann::json data = Data();
  EXPECT_EQ(data["workspace"], "dense <&>");
  ASSERT_EQ(data["images"].size(), 2u);
  const nlohmann::json& image = data["images"][1];
  EXPECT_EQ(image["name"], "left/b.png");
  EXPECT_EQ(image["folder"], "00001_left_b.png");
  EXPECT_EQ(image["width"], 4);
  EXPECT_EQ(image["before"], 12);
  EXPECT_EQ(image["after"], 11);
  EXPECT_EQ(image["provenance"], (nlohmann::json{1, 1, 0, 0, 10, 0, 0, 0}));
  EXPECT_EQ(image["seconds"]["matching"], 1.5);
  EXPECT_EQ(image["note"], "depth prior not used: it has no depths");
  ASSERT_EQ(data["kept"].size(), 1u);
  EXPECT_EQ(data["kept"][0]["name"], "c.png");
  EXPECT_EQ(data["kept"][0]["reason"], "seen by nobody");
  EXPECT_FALSE(data["points"]["from_clouds"]);
  EXPECT_EQ(data["points"]["shown"], (nlohmann::json{24, 23}));
  EXPECT_EQ(data["points"]["all"], (nlohmann::json{24, 23}));
}

TEST_F(WritePageTest, HasATableOfTheNumbersOfEachImage) {
  Write();
  const std::string table = ReadText(options_.report_path / "data/images.csv");
  EXPECT_THAT(table,
              testing::StartsWith("image,pixels,depth_before,depth_after,"));
  EXPECT_THAT(
      table,
      testing::HasSubstr("\n\"left/b.png\",12,12,11,1,1,0,0,10,0,0,0,1.5\n"));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
}

TEST_F(WritePageTest, HasAllFilesAndEscapesTheTitle) {
  Write();
  for (const PageFile& file : PageFiles()) {
    EXPECT_FALSE(ReadText(options_.report_path / file.name).empty());
  }
  const std::string html = ReadText(options_.report_path / "index.html");
  EXPECT_THAT(html, testing::HasSubstr("<h1>dense &lt;&amp;&gt;</h1>"));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("@TITLE@")));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("http")));
  for (const char* name : {"photo.jpg",
                           "preview.jpg",
                           "depth_before.png",
                           "depth_after.png",
                           "normals_before.png",
                           "normals_after.png",
                           "provenance.png",
                           "confidence.png"}) {
    for (const char* image : {"00000_a.png", "00001_left_b.png"}) {
      EXPECT_FALSE(
          cv::imread((options_.report_path / "images" / image / name).string())
              .empty())
          << image << " " << name;
    }
  }
}

TEST_F(WritePageTest, RefusesAWorkspaceThatAnotherProgramChanges) {
  const WorkspaceLock lock(root_);
  ExpectError(ErrorCode::kUnsupported, {"another program"}, [&] { Write(); });
  EXPECT_FALSE(fs::exists(options_.report_path));
}

TEST_F(WritePageTest, ThreadsChangeNothing) {
  options_.num_threads = 1;
  Write();
  const auto by_one = ReadTree(options_.report_path);
  options_.num_threads = 4;
  options_.overwrite = true;
  Write();
  EXPECT_TRUE(ReadTree(options_.report_path) == by_one);
}

TEST_F(WritePageTest, ListsAllItsFiles) {
  Write();
  std::istringstream list(ReadText(options_.report_path / "data/files.txt"));
  std::vector<std::string> names;
  for (std::string name; std::getline(list, name);) {
    names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  std::vector<std::string> found;
  for (const auto& [path, content] : ReadTree(options_.report_path)) {
    if (content != "folder") {
      found.push_back(path);
    }
  }
  EXPECT_EQ(names, found);
}

TEST_F(WritePageTest, GoesIntoNoFolderOfInputs) {
  for (const char* folder : {"images", "sparse", "stereo"}) {
    options_.report_path = root_ / folder / "report";
    ExpectFailure(ErrorCode::kUnsupported, {folder, "report_path"});
    fs::create_directory_symlink(root_ / folder, folder_.Path() / folder);
    options_.report_path = folder_.Path() / folder / "report";
    ExpectFailure(ErrorCode::kUnsupported, {folder, "report_path"});
  }
}

TEST_F(WritePageTest, KeepsToTheGivenSizes) {
  options_.max_picture_size = 2;
  options_.max_num_points = 4;
  Write();
  const cv::Mat picture = cv::imread(
      (options_.report_path / "images/00000_a.png/depth_after.png").string());
  EXPECT_EQ(picture.cols, 2);
  EXPECT_EQ(Data()["images"][0]["picture_width"], 2);
  const nlohmann::json points = Data()["points"];
  EXPECT_GT(points["shown"][1], 0);
  EXPECT_LE(points["shown"][1], 4);
  EXPECT_EQ(points["all"][1], 23);
}

TEST_F(WritePageTest, ShowsCloudsWhereTheyAreGiven) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n";
  options_.before_path = folder_.Path() / "before.ply";
  options_.after_path = folder_.Path() / "after.ply";
  WriteText(options_.before_path, header + "1 2 3\n");
  WriteText(options_.after_path, header + "1 2\n");
  ExpectFailure(ErrorCode::kCorrupt, {"after.ply"});
  WriteText(options_.after_path, header + "4 5 6\n");
  Write();
  EXPECT_TRUE(Data()["points"]["from_clouds"]);
  EXPECT_EQ(Data()["points"]["shown"], (nlohmann::json{1, 1}));
  EXPECT_FALSE(Data()["points"]["before_from_maps"]);
  // Without the one before, the points of the original maps.
  options_.before_path.clear();
  options_.overwrite = true;
  options_.max_num_points = 1000000;
  Write();
  EXPECT_TRUE(Data()["points"]["from_clouds"]);
  EXPECT_TRUE(Data()["points"]["before_from_maps"]);
  EXPECT_GT(Data()["points"]["shown"][0], 1);
  EXPECT_EQ(Data()["points"]["shown"][1], 1);
  options_.scans_path = "scans.mlp";
  ExpectFailure(ErrorCode::kBadOption, {"scans_path", "before_path"});
  options_.scans_path.clear();
  options_.before_path = options_.after_path;
  options_.after_path.clear();
  ExpectFailure(ErrorCode::kBadOption, {"before_path", "after_path"});
}

TEST_F(WritePageTest, ScoresBothTheOriginalsAndTheRefinedMaps) {
  // The geometric depth before is 2, 4 and 6; after, 9, 9 and 6.
  const fs::path truth = folder_.Path() / "truth";
  fs::create_directories(truth / "left");
  WriteDepthMap(UserPath(truth / "a.png.bin"), Image<float>(4, 3, 9.f));
  WriteDepthMap(UserPath(truth / "c.png.bin"), Image<float>(4, 3, 6.f));
  options_.ground_truth_path = truth;
  options_.tolerances = {0.1};
  Write();
  const nlohmann::json rows = Data()["gains"]["depth"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["before"]["recall"], 0.5);
  EXPECT_EQ(rows[0]["after"]["recall"], 1.0);
  options_.ground_truth_path = folder_.Path() / "nowhere";
  options_.overwrite = true;
  ExpectFailure(ErrorCode::kNotFound, {"nowhere"});
}

TEST_F(WritePageTest, StopsWhenAskedAndLeavesNothing) {
  const auto before = ReadTree(root_);
  std::ostringstream out;
  Progress progress(out, false);
  ExpectError(ErrorCode::kInterrupted, {"no page was written"}, [&] {
    WritePage(Workspace(root_, MapType::kGeometric), options_, progress, [] {
      return true;
    });
  });
  EXPECT_TRUE(ReadTree(root_) == before);
}

TEST_F(WritePageTest, ShowsSigmaOfImagesThatHaveIt) {
  Write();
  const nlohmann::json images = Data()["images"];
  EXPECT_EQ(images[0]["has_sigma"], false);
  EXPECT_EQ(images[1]["has_sigma"], true);
  const fs::path pictures = options_.report_path / "images";
  EXPECT_FALSE(fs::exists(pictures / "00000_a.png/sigma.png"));
  const cv::Mat sigma =
      cv::imread((pictures / "00001_left_b.png/sigma.png").string());
  // 0.5 % of the depth is half of the scale; there is no depth at (0, 0).
  const Rgb half = ColorizeValues(Image<float>(1, 1, 0.5f), 1.f)(0, 0);
  EXPECT_NEAR(sigma.at<cv::Vec3b>(1, 1)[1], half.g, 2);
  EXPECT_EQ(sigma.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 0));
}

TEST_F(WritePageTest, ShowsDepthPriorsInTheColorsOfDepth) {
  prior_path_ = folder_.Path() / "priors";
  fs::create_directories(prior_path_);
  // At another size and in another unit.
  cv::imwrite((prior_path_ / "a.png").string(),
              cv::Mat(6, 8, CV_16U, cv::Scalar(1234)));
  Write();
  EXPECT_EQ(Data()["images"][0]["has_prior"], true);
  EXPECT_EQ(Data()["images"][1]["has_prior"], false);
  const fs::path pictures = options_.report_path / "images/00000_a.png";
  const cv::Mat prior = cv::imread((pictures / "prior.png").string());
  const cv::Mat before = cv::imread((pictures / "depth_before.png").string());
  ASSERT_EQ(prior.size(), cv::Size(8, 6));
  EXPECT_EQ(prior.at<cv::Vec3b>(3, 3), before.at<cv::Vec3b>(1, 1));
}

TEST_F(WritePageTest, DamagedMapsAreOneErrorAndNoPage) {
  const fs::path sigma = root_ / "stereo/sigma_maps/left/b.png.geometric.npy";
  const std::string whole = ReadText(sigma);
  WriteText(sigma, whole.substr(0, whole.size() - 1));
  ExpectFailure(ErrorCode::kCorrupt, {"sigma_maps/left/b.png.geometric.npy"});
  WriteText(sigma, whole);
  WriteText(root_ / "stereo/confidence_maps/a.png.geometric.png", "no picture");
  ExpectFailure(ErrorCode::kCorrupt, {"confidence_maps/a.png.geometric.png"});
}

TEST(WritePage, WantsARefinedWorkspace) {
  const TemporaryFolder folder;
  MakeTestWorkspace(folder.Path());
  std::ostringstream out;
  Progress progress(out, false);
  PageOptions options;
  options.report_path = folder.Path() / "report";
  ExpectError(ErrorCode::kNotFound, {"run tsar_refine on it first"}, [&] {
    WritePage(
        Workspace(folder.Path(), MapType::kGeometric), options, progress, [] {
          return false;
        });
  });
  EXPECT_FALSE(fs::exists(options.report_path));
}

}  // namespace
}  // namespace tsar
