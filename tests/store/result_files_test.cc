// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/result_files.h"

#include "colmap_tsar/base/half.h"
#include "colmap_tsar/store/originals.h"
#include "colmap_tsar/store/restore.h"
#include "colmap_tsar/store/write_back.h"
#include "colmap_tsar/workspace/map_io.h"
#include "colmap_tsar/workspace/sigma_map.h"

#include <filesystem>

#include "tests/store/write_back_testing.h"
#include "tests/support/test_workspace.h"
#include "tests/support/write_refined.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(WriteBackTest, WritesSigmaWhereItIsAskedFor) {
  const auto clean = Snapshot(root_);
  const std::filesystem::path path =
      workspace().SigmaPath(1, MapType::kGeometric);
  EXPECT_EQ(path, root_ / "stereo/sigma_maps/left/b.png.geometric.npy");
  RefinedMaps maps = MakeRefinedMaps(42.f);
  maps.sigma = Image<uint16_t>(4, 3, ToPositiveHalf(0.25f));
  WriteRefined(workspace(), 1, maps, Record());
  EXPECT_EQ(ReadSigmaMap(path)(3, 2), 0.25f);
  EXPECT_TRUE(IsDone(workspace(), 1, "options", {}));
  // One that is gone is made again.
  std::filesystem::remove(path);
  EXPECT_FALSE(IsDone(workspace(), 1, "options", {}));
  WriteRefined(workspace(), 1, maps, Record());
  // That of an earlier refinement does not outlive it.
  WriteRefined(workspace(), 1, MakeRefinedMaps(43.f), Record());
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_TRUE(IsDone(workspace(), 1, "options", {}));
  maps.sigma = Image<uint16_t>(3, 4, 1);
  ExpectError(ErrorCode::kMismatch, {"left/b.png", "differ in size"}, [&] {
    WriteRefined(workspace(), 1, maps, Record());
  });
  maps.sigma = Image<uint16_t>(4, 3, 1);
  WriteRefined(workspace(), 1, maps, Record());
  KeepImage(workspace(), 1, Record());
  EXPECT_FALSE(std::filesystem::exists(path));
  WriteRefined(workspace(), 1, maps, Record());
  Restore(root_);
  EXPECT_EQ(Snapshot(root_), clean);
}

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
