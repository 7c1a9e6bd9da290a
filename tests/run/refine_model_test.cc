// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// The planes of the scene, from the pass that finds them to the file that
// remains.

#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

#include "tests/run/refine_workspace_fixture.h"
#include "tests/support/scene_model_testing.h"

namespace tsar {
namespace {

class RefineModelTest : public RefineWorkspaceTest {
 protected:
  std::filesystem::path Planes() const {
    return root_ / "stereo/tsar/planes.bin";
  }
  // Stops a run once one of the files is there.
  void StopAt(const std::vector<std::filesystem::path>& files) {
    ExpectError(ErrorCode::kInterrupted, {"same command"}, [&] {
      Refine(Options(root_), {}, [&] {
        return std::ranges::any_of(files, [](const auto& file) {
          return std::filesystem::exists(file);
        });
      });
    });
  }
};

TEST_F(RefineModelTest, LeavesThePlanesWithoutLabels) {
  Refine();
  const SceneModel model = ReadSceneModel(Planes());
  EXPECT_FALSE(model.planes.empty());
  EXPECT_TRUE(model.views.empty());
  // The same maps elsewhere and at another time give the same bytes.
  const std::string bytes = ReadText(Planes());
  RefinedInOneGo();
  EXPECT_TRUE(ReadText(folder_.Path() / "whole/stereo/tsar/planes.bin") ==
              bytes);
  // Nothing is left to be done.
  EXPECT_EQ(Refine().num_refined, 0);
  EXPECT_TRUE(ReadText(Planes()) == bytes);
  Restore(root_);
  EXPECT_FALSE(std::filesystem::exists(Planes()));
  EXPECT_FALSE(std::filesystem::exists(root_ / "stereo/plane_maps"));
}

TEST_F(RefineModelTest, EveryPixelOfAPlaneMapLiesOnItsPlane) {
  Refine();
  const SceneModel model = ReadSceneModel(Planes());
  const Workspace workspace(root_, MapType::kGeometric);
  for (int view = 0; view < 4; ++view) {
    const std::string& name = SyntheticWorkspace::Names()[view];
    const auto& images = workspace.Model().images;
    const auto image =
        std::find_if(images.begin(), images.end(), [&](const auto& candidate) {
          return candidate.name == name;
        });
    ASSERT_NE(image, images.end());
    const Image<float> depth = ReadDepthMap(Paths(view).depth);
    const Image<uint16_t> planes = ReadGray16Png(Paths(view).planes);
    ASSERT_EQ(planes.Width(), depth.Width());
    ASSERT_EQ(planes.Height(), depth.Height());
    size_t num_on_planes = 0;
    for (int y = 0; y < depth.Height(); ++y) {
      for (int x = 0; x < depth.Width(); ++x) {
        if (planes(x, y) == 0) {
          continue;
        }
        ++num_on_planes;
        ASSERT_LE(planes(x, y), model.planes.size());
        const Plane plane =
            ToCameraPlane(model.planes[planes(x, y) - 1].plane, image->camera);
        const float expected = plane.Depth(image->camera.GetIntrinsics().Ray(
            static_cast<float>(x), static_cast<float>(y)));
        ASSERT_NEAR(depth(x, y), expected, 1e-4f * expected) << x << " " << y;
      }
    }
    EXPECT_GT(num_on_planes, depth.NumPixels() / 2);
  }
}

TEST_F(RefineModelTest, RunsWithoutThePlanesOfTheSceneLeaveNone) {
  Refine();
  EXPECT_FALSE(HasEvidence());
  RefineOptions alone;
  alone.segment = false;
  Observe(Options(root_), alone);
  EXPECT_TRUE(HasEvidence());
  alone.scene_planes = false;
  EXPECT_EQ(Refine(Options(root_), alone).num_refined, 4);
  EXPECT_FALSE(HasEvidence());
  EXPECT_FALSE(std::filesystem::exists(Planes()));
}

TEST_F(RefineModelTest, AKilledRunGoesOnWithItsPlanes) {
  const Tree expected = RefinedInOneGo();
  // While the views are labeled, or before.
  StopAt({Evidence(root_, 3)});
  EXPECT_FALSE(std::filesystem::exists(Planes()));
  // Once the planes are there.
  StopAt({Planes()});
  EXPECT_EQ(ReadSceneModel(Planes()).views.size(), 4u);
  const auto time = std::filesystem::last_write_time(Planes());
  // While the maps are composed.
  StopAt({Paths(0).record, Paths(1).record, Paths(2).record, Paths(3).record});
  EXPECT_TRUE(std::filesystem::last_write_time(Planes()) == time);
  Refine();
  ExpectSameFiles(expected, MapsOf(root_));
}

TEST_F(RefineModelTest, OtherOptionsNeedOtherPlanes) {
  StopAt({Planes()});
  RefineOptions others;
  others.manhattan_frame = false;
  others.min_scene_plane = 60.0;
  EXPECT_EQ(Refine(Options(root_), others).num_refined, 4);
  ExpectSameFiles(RefinedInOneGo(others), MapsOf(root_));
}

TEST_F(RefineModelTest, WarnsOfPlanesThatPlaneMapsCannotName) {
  SceneModel model;
  model.planes.assign(size_t{kMaxPlanesOfMap},
                      MakeModelPlane({0, 0, -1}, {0, 0, 2}));
  const auto warning_of = [&] {
    testing::internal::CaptureStderr();
    WriteSceneModel(UserPath(Planes()), "key", model);
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(warning_of(), "");
  model.planes.resize(65538, model.planes[0]);
  const std::string warning = warning_of();
  for (const char* text : {"the scene has 65538 planes",
                           "can name 65535",
                           "the 3 that least",
                           "stereo/plane_maps",
                           "are complete"}) {
    EXPECT_THAT(warning, testing::HasSubstr(text));
  }
  EXPECT_EQ(warning.find('\n', warning.find("the scene")), warning.size() - 1);
  EXPECT_EQ(ReadSceneModel(Planes()).planes.size(), 65538u);
}

// Two pairs that see nothing of each other.
TEST_F(RefineModelTest, PartsOfAWorkspaceThatNothingConnects) {
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\nv1.png\nv1.png\nv0.png\n"
            "left/v2.png\nv3.png\nv3.png\nleft/v2.png\n");
  EXPECT_EQ(Refine().num_refined, 4);
  std::set<int> components;
  for (const ModelPlane& plane : ReadSceneModel(Planes()).planes) {
    components.insert(plane.component);
  }
  EXPECT_EQ(components, std::set<int>({0, 1}));
}

}  // namespace
}  // namespace tsar
