// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/result_files.h"

#include "colmap_tsar/store/originals.h"
#include "colmap_tsar/store/restore.h"
#include "colmap_tsar/store/write_back.h"
#include "colmap_tsar/workspace/map_io.h"

#include <filesystem>

#include "tests/store/write_back_testing.h"
#include "tests/support/test_workspace.h"
#include "tests/support/write_refined.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// A workspace that was refined by a version with another format of confidence
// maps.
class ResultFilesTest : public WriteBackTest {
 protected:
  void RefineByEarlierVersion() {
    WriteRefined(workspace(), 0, MakeRefinedMaps(42.f), Record());
    const MapPaths paths = Paths();
    std::filesystem::remove(paths.confidence);
    WriteDepthMap(paths.former_confidence, Image<float>(4, 3, 0.5f));
  }
  MapPaths Paths() { return workspace().Paths(0, MapType::kGeometric); }
};

TEST_F(ResultFilesTest, WhatAnEarlierVersionRefinedIsRefinedAnew) {
  RefineByEarlierVersion();
  EXPECT_FALSE(IsDone(workspace(), 0, "options", {}));
  WriteRefined(workspace(), 0, MakeRefinedMaps(43.f), Record());
  EXPECT_TRUE(IsDone(workspace(), 0, "options", {}));
  EXPECT_TRUE(std::filesystem::exists(Paths().confidence));
  EXPECT_FALSE(std::filesystem::exists(Paths().former_confidence));
  EXPECT_EQ(CurrentDepth(0), 43.f);
  EXPECT_EQ(OriginalDepth(0), 2.f);
}

TEST_F(ResultFilesTest, WhatAnEarlierVersionRefinedIsPutBack) {
  const auto clean = Snapshot(root_);
  RefineByEarlierVersion();
  Restore(root_);
  EXPECT_EQ(Snapshot(root_), clean);
  RefineByEarlierVersion();
  KeepImage(workspace(), 0, Record());
  EXPECT_FALSE(std::filesystem::exists(Paths().former_confidence));
  EXPECT_EQ(CurrentDepth(0), 2.f);
}

TEST_F(ResultFilesTest, WhatAnEarlierVersionRefinedIsNoOriginal) {
  RefineByEarlierVersion();
  std::filesystem::remove_all(root_ / "stereo/tsar");
  std::filesystem::remove(Paths().provenance);
  ExpectError(ErrorCode::kMismatch,
              {"has been refined", Paths().former_confidence.string()},
              [&] { RequireNoStrayResults(Paths()); });
}

}  // namespace
}  // namespace tsar
