// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/run/store/write_back_testing.h"

#include "colmap_tsar/io/map_io.h"

namespace tsar {

void WriteBackTest::SetUp() { MakeTestWorkspace(root_); }

ImageRecord WriteBackTest::Record(const std::string& options_hash) {
  ImageRecord record;
  record.options_hash = options_hash;
  return record;
}

float WriteBackTest::CurrentDepth(int image) {
  return ReadDepthMap(workspace().Paths(image, MapType::kGeometric).depth)(0,
                                                                           0);
}

float WriteBackTest::OriginalDepth(int image) {
  const DepthNormal maps =
      workspace().ReadOriginalMaps(image, MapType::kGeometric);
  // Every original of the test workspace has its depth in the normal, too.
  EXPECT_EQ(maps.normal(0, 0).z, -maps.depth(0, 0));
  return maps.depth(0, 0);
}

const Workspace& WriteBackTest::workspace() {
  if (!workspace_) {
    workspace_.emplace(root_, MapType::kGeometric);
  }
  return *workspace_;
}

}  // namespace tsar
