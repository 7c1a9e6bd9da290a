// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/pictures.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/tools/report/page_text.h"

#include <filesystem>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

class PngTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(PngTest, WrittenColorsAreReadByOthers) {
  Image<Rgb> image(2, 1);
  image(0, 0) = {255, 10, 20};
  image(1, 0) = {30, 40, 250};
  const fs::path path = folder_ / "colors.png";
  WritePng(UserPath(path), image);
  const cv::Mat read = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_8UC3);
  ASSERT_EQ(read.size(), cv::Size(2, 1));
  EXPECT_EQ(read.at<cv::Vec3b>(0, 0), cv::Vec3b(20, 10, 255));
  EXPECT_EQ(read.at<cv::Vec3b>(0, 1), cv::Vec3b(250, 40, 30));
}

TEST_F(PngTest, WritingIntoAMissingFolderIsAnError) {
  EXPECT_THROW(WritePng(UserPath(folder_ / "none" / "a.png"), Image<Rgb>(1, 1)),
               Error);
}

using testing::HasSubstr;
using testing::Not;

TEST(EscapeHtml, LeavesNothingThatMeansMarkup) {
  EXPECT_EQ(EscapeHtml("a<b>\"c\" & 'd'"),
            "a&lt;b&gt;&quot;c&quot; &amp; &#39;d&#39;");
  EXPECT_EQ(EscapeHtml("&lt;"), "&amp;lt;");
  EXPECT_EQ(EscapeHtml(""), "");
}

TEST(EscapeScript, CannotEndTheScriptOrTheLine) {
  EXPECT_EQ(EscapeScript("\"</script><!--\""), "\"\\u003c/script>\\u003c!--\"");
  EXPECT_EQ(EscapeScript("\"\xE2\x80\xA8\xE2\x80\xA9\""), "\"\\u2028\\u2029\"");
  EXPECT_EQ(EscapeScript("{\"a\": 1}"), "{\"a\": 1}");
}

TEST(SafeFileName, KeepsWhatIsPlain) {
  EXPECT_EQ(SafeFileName(7, "DSC-0001.JPG"), "00007_DSC-0001.JPG");
  EXPECT_EQ(SafeFileName(123456, "a.png"), "123456_a.png");
}

TEST(SafeFileName, IsOneHarmlessNameWhateverTheImageIsCalled) {
  const std::string hostile[] = {"../../etc/passwd",
                                 "left/0001.jpg",
                                 "..",
                                 ".",
                                 "",
                                 "a.",
                                 "\"><script>alert(1)</script>.png",
                                 "a\\b:c*d?e|f",
                                 "%2e%2e%2f",
                                 std::string("nul\0l.png", 9),
                                 "caf\xC3\xA9 \n.jpg",
                                 std::string(1000, 'x') + ".jpg"};
  std::set<std::string> names;
  for (const std::string& name : hostile) {
    const std::string safe = SafeFileName(1, name);
    EXPECT_EQ(safe.find_first_not_of("0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                     "abcdefghijklmnopqrstuvwxyz-._"),
              std::string::npos)
        << safe;
    EXPECT_THAT(safe, Not(HasSubstr("..")));
    EXPECT_NE(safe.back(), '.');
    EXPECT_LE(safe.size(), 64u);
  }
}

TEST(SafeFileName, DiffersWhereOnlyTheNumberDoes) {
  EXPECT_NE(SafeFileName(1, "a/b"), SafeFileName(2, "a_b"));
}

}  // namespace
}  // namespace tsar
