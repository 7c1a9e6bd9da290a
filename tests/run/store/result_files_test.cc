// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/result_files.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/write_back.h"

#include <filesystem>

#include "tests/run/store/write_back_testing.h"
#include "tests/support/test_workspace.h"
#include "tests/support/write_refined.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(WriteBackTest, WritesSigmaWhereItIsAskedFor) {
  const auto clean = Snapshot(root_);
  const std::filesystem::path path =
      workspace().Paths(1, MapType::kGeometric).sigma;
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

// What is missing, damaged or another scene's is made again.
TEST_F(WriteBackTest, IsDoneWithAllItsFilesAlone) {
  RefinedMaps maps = MakeRefinedMaps(42.f);
  maps.planes = Image<uint16_t>(4, 3, 7);
  maps.sigma = Image<uint16_t>(4, 3, 1);
  RefinedMaps others = maps;
  others.confidence = Image<float>(4, 3, 0.25f);
  others.provenance = Image<uint8_t>(4, 3, 1);
  others.planes = Image<uint16_t>(4, 3, 8);
  others.sigma = Image<uint16_t>(4, 3, 2);
  WriteRefined(workspace(), 1, others, Record());
  const MapPaths paths = workspace().Paths(0, MapType::kGeometric);
  const MapPaths other_paths = workspace().Paths(1, MapType::kGeometric);
  const auto files = ResultFiles(paths);
  for (size_t i = 0; i < files.size(); ++i) {
    SCOPED_TRACE(files[i].name);
    const auto refine = [&] {
      WriteRefined(workspace(), 0, maps, Record());
      return IsDone(workspace(), 0, "options", {});
    };
    EXPECT_TRUE(refine());
    std::filesystem::remove(*files[i].path);
    EXPECT_FALSE(IsDone(workspace(), 0, "options", {}));
    EXPECT_TRUE(refine());
    std::string bytes = ReadText(*files[i].path);
    WriteText(*files[i].path, bytes);  // Copied without its time.
    EXPECT_TRUE(IsDone(workspace(), 0, "options", {}));
    bytes.pop_back();
    WriteText(*files[i].path, bytes);
    EXPECT_FALSE(IsDone(workspace(), 0, "options", {}));
    EXPECT_TRUE(refine());
    WriteText(*files[i].path, ReadText(*ResultFiles(other_paths)[i].path));
    EXPECT_FALSE(IsDone(workspace(), 0, "options", {}));
  }
}

}  // namespace
}  // namespace tsar
