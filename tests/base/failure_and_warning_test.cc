// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/warning.h"

#include <filesystem>
#include <new>
#include <stdexcept>
#include <tuple>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace tsar {
namespace {

template <typename Function>
std::exception_ptr FailureOf(Function function) {
  try {
    function();
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

// A matrix of these exceeds the address space of any machine.
constexpr int kManyRows = 1 << 24;
constexpr int kManyColumns = 1 << 22;

TEST(Failure, MemoryThatRanOutInThisCodeAndInOpenCv) {
  for (const std::exception_ptr& failure :
       {FailureOf([] { throw std::bad_alloc(); }),
        FailureOf([] { throw std::bad_array_new_length(); }),
        FailureOf([] { cv::Mat(kManyRows, kManyColumns, CV_64FC4); })}) {
    ASSERT_TRUE(failure);
    EXPECT_TRUE(IsOutOfMemory(failure)) << FailureText(failure);
    EXPECT_EQ(FailureText(failure), kOutOfMemory);
  }
}

TEST(Failure, OtherExceptionsAreSomethingElse) {
  const std::exception_ptr own =
      FailureOf([] { throw Error(ErrorCode::kIo, "a.bin: gone; look"); });
  EXPECT_FALSE(IsOutOfMemory(own));
  EXPECT_EQ(FailureText(own), "a.bin: gone; look");
  const std::exception_ptr opencv =
      FailureOf([] { CV_Error(cv::Error::StsBadArg, "no"); });
  EXPECT_FALSE(IsOutOfMemory(opencv));
  EXPECT_EQ(FailureText(opencv).find("unexpected failure: "), 0u);
  EXPECT_EQ(FailureText(FailureOf([] { throw std::runtime_error("no idea"); })),
            "unexpected failure: no idea");
  EXPECT_EQ(FailureText(FailureOf([] { throw 7; })), "unexpected failure");
  EXPECT_EQ(FailureText(FailureOf([] {
              std::ignore = std::filesystem::file_size("/nowhere/a.bin");
            })),
            "/nowhere/a.bin: No such file or directory; check the path and its "
            "permissions");
}

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
