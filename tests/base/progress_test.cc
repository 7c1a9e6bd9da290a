// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/progress.h"

#include <sstream>
#include <string>
#include <vector>

#include "tests/support/test_workspace.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tsar {
namespace {

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

TEST_F(ProgressTest, WritesALineEveryTenSecondsAndOneAtTheEnd) {
  EXPECT_EQ(Print(2, false), "[2/2]\n");
  EXPECT_EQ(Print(23, false), "[10/23] 13 s left\n[20/23] 3 s left\n[23/23]\n");
  const std::string hours = Print(20000, false);
  EXPECT_THAT(hours, testing::StartsWith("[10/20000] 5 h 33 min left\n"));
  EXPECT_THAT(hours, testing::HasSubstr("\n[19000/20000] 17 min left\n"));
}

TEST_F(ProgressTest, KeepsOneLineOnATerminal) {
  EXPECT_EQ(Print(2, true), "\r[1/2] 1 s left\r[2/2]         \n");
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
    // Images that need no work may take time, too.
    progress.Start(2);
    now += 11.0;
    progress.Advance(false);
    progress.Finish();
    EXPECT_EQ(text.str(), is_terminal ? "\r[1/2]\n" : "[1/2]\n");
  }
}

// Images that were done before took no time.
TEST(Progress, NamesThePassAndCountsWorkAlone) {
  std::ostringstream text;
  double now = 0.0;
  Progress progress(text, false, [&] { return now; });
  for (const char* pass : {"Pass 1 of 2:", ""}) {
    progress.Start(1, pass);
    now += 1.0;
    progress.Advance(true);
    progress.Finish();
  }
  EXPECT_EQ(text.str(), "Pass 1 of 2: [1/1]\n[1/1]\n");
  text.str("");
  progress.Start(12);
  for (int i = 0; i < 9; ++i) {
    progress.Advance(false);
  }
  now += 10.0;
  progress.Advance(true);
  EXPECT_EQ(text.str(), "[10/12] 20 s left\n");
}

TEST(Progress, TellsTheListenerOfStartsAndOfEveryImage) {
  std::ostringstream text;
  // Only the last image is due to be printed.
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

TEST(Progress, TellsWhetherTheUserAskedToStop) {
  std::ostringstream text;
  Progress progress(text, true, [] { return 0.0; });
  EXPECT_FALSE(progress.ShouldStop());
  bool should_stop = false;
  progress.SetStop([&] { return should_stop; });
  progress.Start(1);
  progress.Advance(true);
  progress.ThrowIfStopped("stopped");
  should_stop = true;
  EXPECT_TRUE(progress.ShouldStop());
  ExpectError(ErrorCode::kInterrupted, {"stopped"}, [&] {
    progress.ThrowIfStopped("stopped");
  });
  EXPECT_THAT(text.str(), testing::EndsWith("\n"));
}

}  // namespace
}  // namespace tsar
