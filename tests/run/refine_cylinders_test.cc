// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Whole runs on a room with a bare column.

#include "colmap_tsar/compose/compose_map.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/scene_model_file.h"

#include <atomic>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tests/run/refine_shard_fixture.h"
#include "tests/support/column_workspace.h"

namespace tsar {
namespace {

class RefineCylindersTest : public RefineShardTest {
 protected:
  void SetUp() override { MakeColumnWorkspace(root_); }

  // The share of the column's pixels in all views that are within 1 % of the
  // truth.
  static double ShareRight(const std::filesystem::path& root) {
    int num_column = 0;
    int num_right = 0;
    for (int view = 0; view < ColumnWorkspace::kNumViews; ++view) {
      const MapPaths paths =
          GetMapPaths(root, ColumnWorkspace::Name(view), MapType::kGeometric);
      const Image<float> depth = ReadDepthMap(paths.depth);
      for (int y = 0; y < depth.Height(); ++y) {
        for (int x = 0; x < depth.Width(); ++x) {
          bool is_column = false;
          const double truth = ColumnWorkspace::Depth(view, x, y, &is_column);
          if (is_column) {
            ++num_column;
            num_right += std::abs(depth(x, y) - truth) < 0.01 * truth ? 1 : 0;
          }
        }
      }
    }
    return static_cast<double>(num_right) / num_column;
  }
};

TEST_F(RefineCylindersTest, FillsAColumnAndAnyShardsGiveTheSameBytes) {
  const std::filesystem::path whole = folder_.Path() / "whole";
  std::filesystem::copy(root_, whole, std::filesystem::copy_options::recursive);
  EXPECT_EQ(Refine(Options(whole)).num_refined, ColumnWorkspace::kNumViews);
  const SceneModel model = ReadSceneModel(whole / "stereo/tsar/planes.bin");
  ASSERT_EQ(model.cylinders.size(), 1u);
  EXPECT_NEAR(model.cylinders[0].radius, 0.25, 0.01);
  EXPECT_GT(ShareRight(whole), 0.8);

  RunAll("observe", 3);
  RunAll("compose", 3);
  EXPECT_EQ(Run("merge").num_refined, ColumnWorkspace::kNumViews);
  EXPECT_TRUE(ResultOf(root_) == ResultOf(whole));
}

// Outlines of only some of the views would give other circles.
TEST_F(RefineCylindersTest, SearchesNoFurtherOnceItIsToStop) {
  for (const std::string last : {"outlines", "circles"}) {
    std::vector<std::string> parts;
    std::atomic<bool> stops = false;
    std::ostringstream text;
    Progress progress(text, false);
    progress.SetListener([&](const std::string& pass, int num_done, int) {
      if (num_done == 0) {
        parts.push_back(pass);
      }
      stops = pass.ends_with(" " + last + ":") && num_done > 0;
    });
    progress.SetStop([&] { return stops.load(); });
    ExpectError(ErrorCode::kInterrupted, {"same command"}, [&] {
      RefineWorkspace(Options(root_), {}, progress);
    });
    EXPECT_TRUE(parts.back().ends_with(" " + last + ":")) << parts.back();
  }
}

TEST_F(RefineCylindersTest, LeavesItWithoutCylinders) {
  RefineOptions options;
  options.cylinders = false;
  Refine(Options(root_), options);
  EXPECT_TRUE(
      ReadSceneModel(root_ / "stereo/tsar/planes.bin").cylinders.empty());
  EXPECT_LT(ShareRight(root_), 0.3);
}

}  // namespace
}  // namespace tsar
