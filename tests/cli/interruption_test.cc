// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/interruption.h"

#include <csignal>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Interruption, CatchesTheFirstSignal) {
  const auto handler = std::signal(SIGHUP, SIG_DFL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Interruption interruption;
    EXPECT_FALSE(interruption.Requested());
    std::raise(signal);
    EXPECT_TRUE(interruption.Requested());
  }
  std::signal(SIGHUP, handler);
}

// As under nohup.
TEST(Interruption, AnIgnoredHangupStaysIgnored) {
  const auto handler = std::signal(SIGHUP, SIG_IGN);
  {
    const Interruption interruption;
    std::raise(SIGHUP);
    EXPECT_FALSE(interruption.Requested());
  }
  EXPECT_EQ(std::signal(SIGHUP, handler), SIG_IGN);
}

TEST(InterruptionDeathTest, TheSecondSignalEndsTheProgram) {
  EXPECT_EXIT(
      {
        const Interruption interruption;
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      testing::KilledBySignal(SIGINT),
      "");
}

}  // namespace
}  // namespace tsar
