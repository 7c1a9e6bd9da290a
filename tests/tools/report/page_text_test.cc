// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/page_text.h"

#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tsar {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(EscapeHtml, LeavesNothingThatMeansMarkup) {
  EXPECT_EQ(EscapeHtml("a<b>\"c\" & 'd'"),
            "a&lt;b&gt;&quot;c&quot; &amp; &#39;d&#39;");
  EXPECT_EQ(EscapeHtml("&lt;"), "&amp;lt;");
  EXPECT_EQ(EscapeHtml(""), "");
}

TEST(SafeFileName, IsOneHarmlessNameWhateverTheImageIsCalled) {
  EXPECT_EQ(SafeFileName(7, "DSC-0001.JPG"), "00007_DSC-0001.JPG");
  EXPECT_EQ(SafeFileName(123456, "a.png"), "123456_a.png");
  EXPECT_NE(SafeFileName(1, "a/b"), SafeFileName(2, "a_b"));
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

// Every text that may come from files is hostile.
TEST(PageHtml, HostileTextsStayText) {
  const std::string hostile = "\"><script>alert('1')</script>&";
  PageData data;
  data.version = data.workspace = data.type = hostile;
  ImagePage image;
  image.name = image.note = hostile;
  image.folder = "00000_a";
  image.width = image.height = 1;
  data.images = {image};
  data.kept = {{hostile, hostile}};
  data.options = {{hostile, hostile}};
  const std::string html = PageHtml(data);
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(html, Not(HasSubstr("\">\"")));
  int count = 0;
  const std::string escaped = EscapeHtml(hostile);
  for (size_t at = html.find(escaped); at != std::string::npos;
       at = html.find(escaped, at + 1)) {
    ++count;
  }
  // The title twice, the version, the type, and the rest of the texts; the name
  // of the image is in the table and above its pictures.
  EXPECT_EQ(count, 2 + 1 + 1 + 3 + 2 + 2);
}

TEST(PageHtml, WeighsTheMeanByPixels) {
  ImagePage large;
  large.width = 3;
  large.height = 1;
  large.share_before = 1.0;
  large.shares_by_provenance[4] = 1.0;
  ImagePage small;
  small.width = small.height = 1;
  small.share_after = 1.0;
  PageData data;
  data.images = {large, small};
  EXPECT_THAT(PageHtml(data),
              HasSubstr("<b>mean</b></td><td>75.0 %</td><td>25.0 %</td>"
                        "<td>0.0 %</td><td>0.0 %</td><td>0.0 %</td>"
                        "<td>75.0 %</td>"));
}

}  // namespace
}  // namespace tsar
