// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/progress.h"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(ProgressText, SaysHowFastAndHowLong) {
  EXPECT_EQ(ProgressText(31, 31, 500, 10.0),
            "[31/500] 3.1 images/s, 3 min left");
  EXPECT_EQ(ProgressText(2, 2, 4, 9.0), "[2/4] 4.5 s per image, 9 s left");
  EXPECT_EQ(ProgressText(1, 1, 1000, 10.0),
            "[1/1000] 10.0 s per image, 2 h 47 min left");
  EXPECT_EQ(ProgressText(4, 4, 4, 2.0), "[4/4] 2.0 images/s");
}

TEST(ProgressText, ImagesThatNeededNoWorkSayNothingOfTheSpeed) {
  EXPECT_EQ(ProgressText(3, 0, 4, 1.0), "[3/4]");
  EXPECT_EQ(ProgressText(12, 2, 14, 2.0), "[12/14] 1.0 images/s, 2 s left");
}

class ProgressTest : public testing::Test {
 protected:
  // Advances once for each second.
  std::string Print(int num_images, bool is_terminal) {
    std::ostringstream text;
    double now = 100.0;
    Progress progress(text, is_terminal, [&] { return now; });
    progress.Start(num_images);
    for (int i = 0; i < num_images; ++i) {
      now += 1.0;
      progress.Advance(true);
    }
    progress.Finish();
    return text.str();
  }
};

TEST_F(ProgressTest, WritesALinePerImageWhereThereAreFew) {
  EXPECT_EQ(Print(2, false),
            "[1/2] 1.0 images/s, 1 s left\n[2/2] 1.0 images/s\n");
}

TEST_F(ProgressTest, WritesALineEveryTenSecondsWhereThereAreMany) {
  const std::string text = Print(55, false);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6);
  EXPECT_EQ(text.find("[10/55]"), 0u);
  EXPECT_NE(text.find("\n[55/55]"), std::string::npos);
}

TEST_F(ProgressTest, KeepsOneLineOnATerminal) {
  EXPECT_EQ(Print(2, true),
            "\r[1/2] 1.0 images/s, 1 s left\r[2/2] 1.0 images/s          \n");
}

TEST(Progress, NamesThePass) {
  std::ostringstream text;
  double now = 0.0;
  Progress progress(text, false, [&] { return now; });
  for (const char* pass : {"Pass 1 of 2:", ""}) {
    progress.Start(1, pass);
    now += 1.0;
    progress.Advance(true);
    progress.Finish();
  }
  EXPECT_EQ(text.str(),
            "Pass 1 of 2: [1/1] 1.0 images/s\n[1/1] 1.0 images/s\n");
}

}  // namespace
}  // namespace tsar
