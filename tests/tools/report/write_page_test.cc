// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/write_page.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/run/store/write_back.h"
#include "colmap_tsar/tools/report/colors.h"

#include <algorithm>
#include <regex>
#include <sstream>

#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

// Of the three images, the first two are refined and the third is kept.
class WritePageTest : public testing::Test {
 protected:
  void SetUp() override {
    MakeTestWorkspace(root_);
    const Workspace workspace(root_, MapType::kGeometric);
    ImageRecord record;
    record.seconds = {{"matching", 1.25}, {"upload", 0.25}};
    record.note = "depth prior <not> used";
    RefinedMaps maps = MakeRefinedMaps(9.f);
    WriteRefined(workspace, 0, maps, record);
    maps.depth(0, 0) = 0.f;
    maps.provenance(0, 0) = 0;
    maps.provenance(1, 0) = 1;
    maps.planes = Image<uint16_t>(4, 3, 1);
    WriteRefined(workspace, 1, maps, record);
    record.note = "seen by nobody";
    KeepImage(workspace, 2, record);
    WriteText(root_ / "stereo/tsar/manifest.json",
              R"({"options": {"refine": "1", "text": "<b>"}})");
    options_.report_path = root_ / "report";
  }

  int Write(bool is_stopped = false) const {
    std::ostringstream out;
    Progress progress(out, false);
    progress.SetStop([&] { return is_stopped; });
    return WritePage(Workspace(root_, MapType::kGeometric), options_, progress);
  }
  std::string Html() const {
    return ReadText(options_.report_path / "index.html");
  }
  cv::Mat Picture(const std::string& path) const {
    return cv::imread((options_.report_path / "images" / path).string());
  }

  void ExpectFailure(ErrorCode code, const std::vector<std::string>& texts) {
    const auto before = ReadTree(root_);
    ExpectError(code, texts, [&] { Write(); });
    EXPECT_TRUE(ReadTree(root_) == before);
  }

  TemporaryFolder folder_;
  const fs::path root_ = folder_.Path() / "dense <&>";
  PageOptions options_;
};

TEST_F(WritePageTest, ShowsNumbersNotesAndOptions) {
  EXPECT_EQ(Write(), 2);
  const std::string html = Html();
  for (const char* text :
       {"<h1>dense &lt;&amp;&gt;</h1>",
        "2 refined images, geometric maps",
        "left/b.png</a></td><td>100.0 %</td><td>91.7 %</td><td>8.3 %</td>"
        "<td>0.0 %</td><td>0.0 %</td><td>83.3 %</td>",
        "<td>1.50</td><td>depth prior &lt;not&gt; used</td>",
        "<td>c.png</td><td>seen by nobody</td>",
        "<td>refine</td><td>1</td>",
        "<td>text</td><td>&lt;b&gt;</td>"}) {
    EXPECT_THAT(html, HasSubstr(text));
  }
  EXPECT_THAT(html, Not(HasSubstr("http")));
}

// And all that the page refers to is there.
TEST_F(WritePageTest, ShowsThePicturesOfEachImage) {
  Write();
  const std::string html = Html();
  const std::regex source("src=\"images/([^\"]*)\"");
  std::vector<std::string> names;
  for (std::sregex_iterator match(html.begin(), html.end(), source), end;
       match != end;
       ++match) {
    names.push_back((*match)[1]);
    EXPECT_EQ(Picture(names.back()).size(), cv::Size(4, 3)) << names.back();
  }
  std::vector<std::string> expected;
  for (const char* name : {"photo.jpg",
                           "depth_before.png",
                           "depth_after.png",
                           "provenance.png",
                           "confidence.png",
                           "normals_before.png",
                           "normals_after.png"}) {
    expected.push_back(std::string("00000_a.png/") + name);
    expected.push_back(std::string("00001_left_b.png/") + name);
  }
  expected.push_back("00001_left_b.png/planes.png");
  std::ranges::sort(names);
  std::ranges::sort(expected);
  EXPECT_EQ(names, expected);
  const auto color_at = [&](const char* name, int x, int y) {
    const cv::Vec3b bgr =
        Picture(std::string("00001_left_b.png/") + name).at<cv::Vec3b>(y, x);
    return std::vector<int>{bgr[2], bgr[1], bgr[0]};
  };
  const std::vector<int> black = {0, 0, 0};
  EXPECT_EQ(color_at("depth_after.png", 0, 0), black);
  EXPECT_NE(color_at("depth_before.png", 0, 0), black);
  EXPECT_EQ(color_at("provenance.png", 0, 0), black);
  const Rgb& measured = kProvenanceColors[1];
  EXPECT_EQ(color_at("provenance.png", 1, 0),
            (std::vector<int>{measured.r, measured.g, measured.b}));
}

TEST_F(WritePageTest, ShowsWhatIsThere) {
  fs::remove_all(root_ / "stereo/confidence_maps");
  WriteText(root_ / "stereo/tsar/manifest.json", "no JSON");
  Write();
  EXPECT_THAT(Html(), Not(HasSubstr("confidence.png")));
  EXPECT_THAT(Html(), Not(HasSubstr("Options of the run")));
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

TEST_F(WritePageTest, GoesIntoNoFolderOfInputs) {
  for (const char* folder : {"images", "sparse", "stereo"}) {
    fs::create_directory_symlink(root_ / folder, folder_.Path() / folder);
    options_.report_path = folder_.Path() / folder / "report";
    ExpectFailure(ErrorCode::kUnsupported, {folder, "report_path"});
  }
}

TEST_F(WritePageTest, PicturesKeepToTheGivenSize) {
  options_.max_picture_size = 2;
  Write();
  EXPECT_EQ(Picture("00000_a.png/depth_after.png").size(), cv::Size(2, 2));
  EXPECT_EQ(Picture("00000_a.png/photo.jpg").size(), cv::Size(2, 2));
  EXPECT_THAT(Html(), HasSubstr("width=\"2\" height=\"2\""));
}

TEST_F(WritePageTest, StopsWhenAskedAndLeavesNothing) {
  const auto before = ReadTree(root_);
  ExpectError(ErrorCode::kInterrupted, {"no page was written"}, [&] {
    Write(/*is_stopped=*/true);
  });
  EXPECT_TRUE(ReadTree(root_) == before);
}

TEST_F(WritePageTest, DamagedMapsAreOneErrorAndNoPage) {
  const fs::path normal = root_ / "stereo/normal_maps/a.png.geometric.bin";
  const std::string whole = ReadText(normal);
  WriteNormalMap(UserPath(normal), Image<Vec3f>(2, 3));
  ExpectFailure(ErrorCode::kMismatch, {normal.string()});
  WriteText(normal, whole);
  const fs::path kinds = root_ / "stereo/provenance_maps/a.png.geometric.png";
  cv::imwrite(kinds.string(), cv::Mat(3, 4, CV_8UC1, cv::Scalar(8)));
  ExpectFailure(ErrorCode::kCorrupt, {kinds.string(), "unknown value 8"});
  WriteText(root_ / "stereo/confidence_maps/a.png.geometric.png", "no picture");
  ExpectFailure(ErrorCode::kCorrupt, {"confidence_maps/a.png.geometric.png"});
}

}  // namespace
}  // namespace tsar
