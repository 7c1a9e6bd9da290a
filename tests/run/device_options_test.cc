// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/device_options.h"

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

TEST(ParseGpuIndices, ReadsListsInTheirOrder) {
  EXPECT_TRUE(ParseGpuIndices("-1").empty());
  EXPECT_EQ(ParseGpuIndices("0"), std::vector<int>({0}));
  EXPECT_EQ(ParseGpuIndices("3,0,11"), std::vector<int>({3, 0, 11}));
  EXPECT_EQ(ParseGpuIndices(" 0, 1 "), std::vector<int>({0, 1}));
}

TEST(ParseGpuIndices, RefusesEverythingElse) {
  for (const char* text : {"",
                           ",",
                           "0,",
                           ",0",
                           "0,,1",
                           "all",
                           "0x1",
                           "1.5",
                           "0 1",
                           "+1",
                           "0;1",
                           "99999999999999999999"}) {
    SCOPED_TRACE(text);
    ExpectError(ErrorCode::kBadOption,
                {"gpu_index", "not a list", "-1", "0,1"},
                [&] { ParseGpuIndices(text); });
  }
  ExpectError(ErrorCode::kBadOption, {"gpu_index", "GPU -2"}, [] {
    ParseGpuIndices("-2");
  });
  ExpectError(ErrorCode::kBadOption, {"gpu_index", "GPU -1"}, [] {
    ParseGpuIndices("0,-1");
  });
  ExpectError(ErrorCode::kBadOption, {"gpu_index", "GPU 1 is named twice"}, [] {
    ParseGpuIndices("1,0,1");
  });
}

TEST(GpuIndicesText, IsReadBack) {
  for (const char* text : {"-1", "0", "3,0,11"}) {
    EXPECT_EQ(GpuIndicesText(ParseGpuIndices(text)), text);
  }
}

}  // namespace
}  // namespace tsar
