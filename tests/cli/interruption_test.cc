// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/interruption.h"

#include <csignal>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Interruption, CatchesTheFirstSignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Interruption interruption;
    EXPECT_FALSE(interruption.Requested());
    std::raise(signal);
    EXPECT_TRUE(interruption.Requested());
  }
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
