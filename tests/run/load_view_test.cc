// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/load_view.h"

#include "colmap_tsar/io/map_io.h"

#include <algorithm>
#include <filesystem>

#include "tests/support/same_bytes.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

class LoadViewTest : public testing::Test {
 protected:
  void SetUp() override { MakeSyntheticWorkspace(root_); }

  ViewData Load(MapType type) const {
    return LoadView(Workspace(root_, type), 1);
  }
  // Writes geometric costs without evidence for the first pixels of the view.
  void WriteCosts(const Image<float>& depth,
                  size_t num_without_evidence) const {
    std::vector<float> costs(2 * depth.NumPixels(), 0.1f);
    std::fill_n(costs.begin(), num_without_evidence, 2.f);
    const ContainedPath path =
        GetMapPaths(root_, "v1.png", MapType::kGeometric).cost;
    CreateFolders(path.Parent());
    WriteMap(path, {depth.Width(), depth.Height(), 2}, costs);
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
};

TEST_F(LoadViewTest, HasTheHypothesesOfItsType) {
  for (const MapType type : kMapTypes) {
    const Image<float> depth =
        ReadDepthMap(GetMapPaths(root_, "v1.png", type).depth);
    const ViewData view = Load(type);
    EXPECT_TRUE(SameBytes(view.depth, depth));
    EXPECT_EQ(view.num_depths,
              std::ranges::count_if(depth, [](float z) { return z > 0.f; }));
  }
}

// Costs of depths without evidence from any image.
TEST_F(LoadViewTest, DepthsWithoutEvidenceAreNoHypotheses) {
  const ViewData before = Load(MapType::kGeometric);
  const size_t num_pixels = before.depth.NumPixels();
  WriteCosts(before.depth, num_pixels / 2);
  const ViewData view = Load(MapType::kGeometric);
  for (size_t i = 0; i < num_pixels; ++i) {
    ASSERT_EQ(view.depth.Data()[i],
              i < num_pixels / 2 ? 0.f : before.depth.Data()[i]);
  }
  EXPECT_GT(before.num_depths, view.num_depths);
}

TEST_F(LoadViewTest, AReducedViewIsTheViewReduced) {
  const MapPaths paths = GetMapPaths(root_, "v1.png", MapType::kGeometric);
  Image<float> depth = ReadDepthMap(paths.depth);
  for (const bool has_costs : {false, true}) {
    if (has_costs) {
      std::vector<float> costs;
      for (size_t i = 0; i < 2 * depth.NumPixels(); ++i) {
        costs.push_back(i % 11 == 0 ? 2.f : static_cast<float>(i % 7) / 10.f);
      }
      CreateFolders(paths.cost.Parent());
      WriteMap(paths.cost, {depth.Width(), depth.Height(), 2}, costs);
    }
    const Workspace workspace(root_, MapType::kGeometric);
    const ViewData view = LoadView(workspace, 1);
    ASSERT_NE(view.min_cost.Empty(), has_costs);
    for (const int max_side : {48, 40, 25, 7, 96, 1000}) {
      SCOPED_TRACE(max_side);
      const ViewData reduced = LoadReducedView(workspace, 1, max_side);
      const ViewData expected = ReduceView(
          view,
          ReductionFactor(view.depth.Width(), view.depth.Height(), max_side));
      EXPECT_TRUE(SameBytes(reduced.depth, expected.depth));
      EXPECT_TRUE(SameBytes(reduced.normal, expected.normal));
      EXPECT_TRUE(SameBytes(reduced.color, expected.color));
      EXPECT_TRUE(SameBytes(reduced.min_cost, expected.min_cost));
      EXPECT_EQ(reduced.num_depths, expected.num_depths);
      EXPECT_EQ(reduced.num_not_finite, expected.num_not_finite);
      EXPECT_EQ(reduced.camera.fx, expected.camera.fx);
      EXPECT_EQ(reduced.camera.cy, expected.camera.cy);
    }
  }
}

}  // namespace
}  // namespace tsar
