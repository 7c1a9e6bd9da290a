// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/progress.h"

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

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

TEST(ProgressText, SaysHowLongAllPassesTake) {
  EXPECT_EQ(ProgressText(2, 2, 4, 9.0, 21.0),
            "[2/4] 4.5 s per image, 9 s left (about 30 s of all passes)");
  EXPECT_EQ(ProgressText(4, 4, 4, 2.0, 21.0), "[4/4] 2.0 images/s");
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

TEST_F(ProgressTest, WritesOneLineOfWorkThatIsSoonDone) {
  EXPECT_EQ(Print(2, false), "[2/2] 1.0 images/s\n");
  EXPECT_EQ(Print(9, false), "[9/9] 1.0 images/s\n");
}

TEST_F(ProgressTest, WritesALineEveryTenSeconds) {
  const std::string text = Print(55, false);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6);
  EXPECT_EQ(text.find("[10/55]"), 0u);
  EXPECT_NE(text.find("\n[55/55]"), std::string::npos);
}

TEST_F(ProgressTest, KeepsOneLineOnATerminal) {
  EXPECT_EQ(Print(2, true),
            "\r[1/2] 1.0 images/s, 1 s left\r[2/2] 1.0 images/s          \n");
}

TEST(Progress, SaysNothingWhereNothingHadToBeDone) {
  for (const bool is_terminal : {false, true}) {
    std::ostringstream text;
    double now = 0.0;
    Progress progress(text, is_terminal, [&] { return now; });
    progress.Start(2);
    progress.Advance(false);
    progress.Advance(false);
    progress.Finish();
    EXPECT_EQ(text.str(), "");
    // It may take time, too.
    progress.Start(2);
    now += 11.0;
    progress.Advance(false);
    progress.Finish();
    EXPECT_EQ(text.str(), is_terminal ? "\r[1/2]\n" : "[1/2]\n");
  }
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

// A run of passes; each step of a pass takes a number of seconds.
class PlannedProgressTest : public testing::Test {
 protected:
  // On a terminal, where each image is told.
  PlannedProgressTest() : progress_(text_, true, [this] { return now_; }) {}

  // What is printed of the first image, which takes the seconds.
  std::string FirstLine(int num_images, double seconds) {
    progress_.Start(num_images);
    now_ += seconds;
    text_.str("");
    progress_.Advance(true);
    return text_.str().substr(1);  // After the carriage return.
  }
  void DoRest(int num_images, double seconds) {
    for (int i = 0; i < num_images; ++i) {
      now_ += seconds;
      progress_.Advance(true);
    }
  }

  std::ostringstream text_;
  double now_ = 50.0;
  Progress progress_;
};

TEST_F(PlannedProgressTest, PassesThatAreToComeTakeTimeByTheirCost) {
  progress_.PlanPasses({1.0, 0.5, 2.0});
  progress_.BeginPass();
  EXPECT_EQ(FirstLine(10, 2.0),
            "[1/10] 2.0 s per image, 18 s left (about 68 s of all passes)");
  DoRest(9, 2.0);
  progress_.BeginPass();
  EXPECT_EQ(FirstLine(10, 1.0),
            "[1/10] 1.0 images/s, 9 s left (about 49 s of all passes)");
  DoRest(9, 1.0);
  progress_.BeginPass();
  EXPECT_EQ(FirstLine(10, 4.0), "[1/10] 4.0 s per image, 36 s left");
}

TEST_F(PlannedProgressTest, PartsOfAPassAreJudgedByThePassBefore) {
  progress_.PlanPasses({1.0, 3.0, 2.0});
  progress_.BeginPass();
  FirstLine(10, 1.0);
  DoRest(9, 1.0);
  progress_.BeginPass(/*has_parts=*/true);
  // 30 s for the pass and 20 s after it, of which one has passed.
  EXPECT_EQ(FirstLine(10, 1.0),
            "[1/10] 1.0 images/s, 9 s left (about 49 s of all passes)");
  DoRest(9, 1.0);
  EXPECT_EQ(FirstLine(10, 1.0),
            "[1/10] 1.0 images/s, 9 s left (about 39 s of all passes)");
  DoRest(9, 4.0);
  // It takes longer than was expected.
  EXPECT_EQ(FirstLine(10, 1.0),
            "[1/10] 1.0 images/s, 9 s left (about 29 s of all passes)");
}

TEST_F(PlannedProgressTest, PassesWithNothingToDoSayNothingOfTheOthers) {
  progress_.PlanPasses({1.0, 1.0, 1.0});
  progress_.BeginPass();
  progress_.Start(1);
  now_ += 100.0;
  progress_.Advance(false);
  progress_.BeginPass(/*has_parts=*/true);
  EXPECT_EQ(FirstLine(3, 1.0), "[1/3] 1.0 images/s, 2 s left");
}

TEST_F(PlannedProgressTest, WhatHadBeenDoneBeforeTookNoTime) {
  progress_.PlanPasses({1.0, 3.0, 2.0});
  progress_.BeginPass();
  progress_.Start(10);
  for (int i = 0; i < 9; ++i) {
    progress_.Advance(false);
  }
  DoRest(1, 1.0);
  progress_.BeginPass(/*has_parts=*/true);
  // As if the first pass had taken ten seconds.
  EXPECT_EQ(FirstLine(10, 1.0),
            "[1/10] 1.0 images/s, 9 s left (about 49 s of all passes)");
}

TEST_F(PlannedProgressTest, ASecondPlanReplacesTheFirst) {
  progress_.PlanPasses({1.0, 1.0});
  progress_.BeginPass();
  progress_.PlanPasses({});
  progress_.BeginPass();
  EXPECT_EQ(FirstLine(3, 1.0), "[1/3] 1.0 images/s, 2 s left");
}

TEST(Progress, TellsTheListenerOfStartsAndOfEveryImage) {
  std::ostringstream text;
  // Nothing is due to be printed but the last image.
  Progress progress(text, true, [] { return 0.0; });
  std::vector<std::string> steps;
  progress.SetListener([&](const std::string& pass, int done, int total) {
    steps.push_back(pass + " " + std::to_string(done) + "/" +
                    std::to_string(total));
  });
  progress.Start(2, "Pass 1 of 2:");
  progress.Advance(true);
  progress.Advance(false);
  progress.Start(1);
  progress.Advance(true);
  EXPECT_EQ(steps,
            (std::vector<std::string>{"Pass 1 of 2: 0/2",
                                      "Pass 1 of 2: 1/2",
                                      "Pass 1 of 2: 2/2",
                                      " 0/1",
                                      " 1/1"}));
}

}  // namespace
}  // namespace tsar
