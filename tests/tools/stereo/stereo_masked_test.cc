// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/stereo/stereo_image.h"
#include "colmap_tsar/tools/stereo/stereo_workspace.h"

#include "tests/support/mask_files.h"
#include "tests/tools/stereo/stereo_workspace_fixture.h"

namespace tsar {
namespace {

class StereoMaskedTest : public StereoWorkspaceTest {
 protected:
  // A mask of the second image, of its own size.
  void WriteMaskWhere(bool (*is_masked)(int x, int y)) const {
    WriteMask(folder_.Path() / "masks/v1.png.png",
              SyntheticWorkspace::kWidth,
              SyntheticWorkspace::kHeight,
              is_masked);
  }
  void UseMasks() { mask_path_ = folder_.Path() / "masks"; }
};

TEST_F(StereoMaskedTest, MaskedPixelsGetNoDepth) {
  WriteMaskWhere([](int x, int y) { return x >= 40 && y == 20; });
  UseMasks();
  EXPECT_EQ(Run().num_masks, 1);
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    for (const char* name : {"v0.png", "v1.png"}) {
      const MapPaths paths = GetMapPaths(root_, name, type);
      const Image<float> depth = ReadDepthMap(paths.depth);
      const Image<Vec3f> normal = ReadNormalMap(paths.normal);
      const std::vector<float> costs = ReadCosts(paths.cost);
      ASSERT_EQ(depth.Width(), kMapWidth);
      int num_beside = 0;
      for (int y = 0; y < kMapHeight; ++y) {
        for (int x = 0; x < kMapWidth; ++x) {
          const size_t i = depth.View().Index(x, y);
          if (std::string(name) == "v1.png" && x >= 10 && y == 5) {
            ASSERT_EQ(depth(x, y), 0.f);
            ASSERT_TRUE(normal(x, y) == Vec3f{});
            ASSERT_EQ(costs[i], 2.f);
            ASSERT_EQ(costs[i + depth.NumPixels()], 2.f);
          } else {
            num_beside += depth(x, y) > 0.f ? 1 : 0;
          }
        }
      }
      if (type == MapType::kPhotometric) {
        EXPECT_EQ(num_beside,
                  kMapWidth * kMapHeight -
                      (std::string(name) == "v1.png" ? kMapWidth - 10 : 0));
      } else {
        EXPECT_GT(num_beside, 100);
      }
    }
  }
  EXPECT_EQ(Run().num_skipped, 4);
}

// So that the pixels around them get nothing from them.
TEST_F(StereoMaskedTest, HolesStayHolesInGeometricPasses) {
  const std::filesystem::path root = folder_.Path() / "with_maps";
  MakeSyntheticWorkspace(root);
  const Workspace workspace(root, MapType::kPhotometric);
  std::vector<ViewData> views;
  for (const char* name : {"v1.png", "v0.png", "left/v2.png"}) {
    views.push_back(LoadView(workspace, workspace.Model().IndexOf(name)));
  }
  const auto is_hole = [](int x, int y) { return x > 70 && y < 20; };
  for (int y = 0; y < 20; ++y) {
    for (int x = 71; x < SyntheticWorkspace::kWidth; ++x) {
      views[0].depth(x, y) = 0.f;
      views[0].normal(x, y) = {};
    }
  }
  options_.num_geometric_passes = 2;
  const auto device = Device::CreateCpu(1);
  for (const bool keeps_holes : {false, true}) {
    for (const int pass : {0, 1}) {
      const StereoMaps maps = MatchImageGeometrically(
          views[0],
          UploadViews({&views[1], &views[2]}, *device),
          {0.5 * SyntheticWorkspace::kDepth, 2.0 * SyntheticWorkspace::kDepth},
          1,
          pass,
          keeps_holes,
          options_,
          *device);
      int num_in_hole = 0;
      int num_beside = 0;
      for (int y = 0; y < SyntheticWorkspace::kHeight; ++y) {
        for (int x = 0; x < SyntheticWorkspace::kWidth; ++x) {
          (is_hole(x, y) ? num_in_hole : num_beside) +=
              maps.depth(x, y) > 0.f ? 1 : 0;
        }
      }
      EXPECT_EQ(num_in_hole > 0, !keeps_holes) << pass;
      EXPECT_GT(num_beside, 1000);
    }
  }
}

TEST_F(StereoMaskedTest, MakesMapsAnewWhereMasksHaveChanged) {
  Run();
  const auto whole = Maps();
  const std::string changed =
      "images/v1.png: its mask has changed since the maps were made; give "
      "overwrite 1";
  WriteMaskWhere([](int, int) { return false; });
  UseMasks();
  ExpectRefused(ErrorCode::kUnsupported, changed);
  EXPECT_EQ(Run(/*overwrite=*/true).num_skipped, 0);
  EXPECT_TRUE(Maps() == whole);
  WriteMaskWhere([](int x, int) { return x > 51; });
  Touch(mask_path_ / "v1.png.png");
  ExpectRefused(ErrorCode::kUnsupported, changed);
  Run(/*overwrite=*/true);
  EXPECT_FALSE(Maps() == whole);
  mask_path_.clear();
  ExpectRefused(ErrorCode::kUnsupported, changed);
}

TEST_F(StereoMaskedTest, RefusesMasksThatDoNotFit) {
  WriteMask(folder_.Path() / "masks/v1.png.png", 95, 72, [](int, int) {
    return true;
  });
  UseMasks();
  ExpectRefused(ErrorCode::kMismatch,
                "v1.png.png: the mask has 95 x 72 pixels, its undistorted "
                "image 96 x 72, and its maps 24 x 18");
  mask_path_ = root_ / "sparse";
  ExpectRefused(ErrorCode::kNotFound, "holds no mask of any image");
}

}  // namespace
}  // namespace tsar
