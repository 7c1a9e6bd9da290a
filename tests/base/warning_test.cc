// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/warning.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Warn, IsOneLineOnStandardErrorThatNoTerminalObeys) {
  PrepareWarnings("base_tests");
  PrepareWarnings("base_tests");  // Does nothing.
  testing::internal::CaptureStderr();
  Warn(
      "a\xC2\x9B"
      "2J\n\x1b[31m.png: caf\xC3\xA9");
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "a?2J ?[31m.png: caf\xC3\xA9\n");
}

}  // namespace
}  // namespace tsar
