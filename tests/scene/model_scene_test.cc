// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/model_scene.h"

#include <cmath>
#include <cstdint>
#include <mutex>
#include <set>

#include "tests/run/counting_device.h"
#include "tests/run/drawn_room_fixture.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tsar {
namespace {

class ModelSceneTest : public DrawnRoomTest {
 protected:
  // Every superpixel on one surface is labeled with it, as measured.
  void ExpectSurfaces(const SceneModel& model) const {
    EXPECT_EQ(model.planes.size(), room_.surfaces.size());
    ASSERT_EQ(model.views.size(), views_.size());
    for (size_t view = 0; view < views_.size(); ++view) {
      const ViewLabels& labels = model.views.at(views_[view].image);
      ASSERT_EQ(labels.planes.size(), room_.seen[view].size());
      for (size_t k = 0; k < room_.seen[view].size(); ++k) {
        const int surface = room_.seen[view][k];
        if (surface >= 0) {
          EXPECT_EQ(labels.planes[k], Find(room_.surfaces[surface], model))
              << view << " " << k;
          EXPECT_EQ(labels.origins[k], LabelOrigin::kMeasured);
        }
      }
    }
  }

  // Above the horizon the first view measures the back wall too near, below it
  // too far.
  void LetTheWallLean() {
    ViewEvidence& evidence = room_.evidence[0];
    for (size_t k = 0; k < room_.seen[0].size(); ++k) {
      for (int i = evidence.first_observation[k];
           i < evidence.first_observation[k + 1] && room_.seen[0][k] == 0;
           ++i) {
        RayDepth& sample = evidence.observations[i].sample;
        sample.z *= 1.f + 1.2f * sample.y *
                              evidence.resolution.RelativeDepthError(sample.z);
      }
    }
  }

  // How far the wall is from being at right angles to the floor.
  double Lean(const SceneModel& model) const {
    const int wall = Find(room_.surfaces[0], model);
    const int floor = Find(room_.surfaces[2], model);
    EXPECT_GE(wall, 0);
    EXPECT_GE(floor, 0);
    return wall < 0 || floor < 0 ? 1.0
                                 : std::abs(model.planes[wall].plane.normal.dot(
                                       model.planes[floor].plane.normal));
  }
};

TEST_F(ModelSceneTest, AllViewsShareThePlanesOfTheScene) {
  const std::optional<SceneModel> model = Run();
  ASSERT_TRUE(model);
  ExpectSurfaces(*model);
  EXPECT_THAT(text_.str(), testing::HasSubstr("Model, planes: [3/3]"));
  EXPECT_THAT(text_.str(), testing::HasSubstr("Model, labels 3 of 3: [3/3]"));
}

TEST_F(ModelSceneTest, BlocksOfSingleViewsGiveThePlanesOfOneBlock) {
  options_.max_block_views = 1;
  ExpectSurfaces(*Run());
}

TEST_F(ModelSceneTest, DoesNotDependOnTheResources) {
  options_.max_block_views = 2;
  ExpectSameWithMoreResources(*Run());
}

TEST_F(ModelSceneTest, KeptCostsAreComputedOnce) {
  CountingDevice gpu("first", SIZE_MAX);
  resources_.gpus = {{"GPU", &gpu}};
  const SceneModel without = *Run();
  const int num_allocations = gpu.NumAllocations();
  EXPECT_GT(num_allocations, 0);
  resources_.max_kept_bytes = int64_t{1} << 30;
  ExpectSame(without, *Run());
  EXPECT_LT(gpu.NumAllocations() - num_allocations, num_allocations);
}

TEST_F(ModelSceneTest, AWallThatLeansInOneViewIsUpright) {
  LetTheWallLean();
  options_.max_block_views = 1;
  const SceneModel model = *Run();
  EXPECT_LT(Lean(model), 1e-12);
  ASSERT_EQ(model.frames.size(), 1u);
  for (const ModelPlane& plane : model.planes) {
    ASSERT_EQ(plane.frame, 0);
    EXPECT_NEAR(
        std::abs(model.frames[0].col(plane.axis).dot(plane.plane.normal)),
        1.0,
        1e-12);
    EXPECT_LT(std::abs(plane.plane.Height(plane.center)), 1e-9);
    EXPECT_TRUE(plane.covariance.allFinite());
    EXPECT_GT(plane.covariance(2, 2), 0.0);
  }
}

TEST_F(ModelSceneTest, WithoutTheAdjustmentPlanesStayAsTheyWereJoined) {
  LetTheWallLean();
  options_.max_block_views = 1;
  refine_options_.adjust_planes = false;
  const SceneModel model = *Run();
  EXPECT_GT(Lean(model), 1e-6);
  const int wall = Find(room_.surfaces[0], model);
  ASSERT_GE(wall, 0);
  EXPECT_EQ(model.planes[wall].axis, -1);
  for (const ModelPlane& plane : model.planes) {
    EXPECT_TRUE(plane.covariance.allFinite());
    EXPECT_LT(std::abs(plane.plane.Height(plane.center)), 1e-9);
  }
}

TEST_F(ModelSceneTest, TheAdjustmentLeavesPlanesOfOneBlockAsTheyWereFound) {
  LetTheWallLean();
  const SceneModel adjusted = *Run();
  for (const ModelPlane& plane : adjusted.planes) {
    EXPECT_EQ(plane.frame, 0);
    EXPECT_GE(plane.axis, 0);
  }
  refine_options_.adjust_planes = false;
  ExpectSame(adjusted, *Run());
}

TEST_F(ModelSceneTest, ViewsThatNothingConnectsShareNothing) {
  for (SceneView& view : views_) {
    view.sources.clear();
  }
  const SceneModel model = *Run();
  std::set<int> components;
  for (size_t view = 0; view < views_.size(); ++view) {
    for (const int plane : model.views.at(views_[view].image).planes) {
      if (plane >= 0) {
        EXPECT_EQ(model.planes[plane].component, static_cast<int>(view));
        components.insert(static_cast<int>(view));
      }
    }
  }
  EXPECT_EQ(components.size(), 3u);
}

TEST_F(ModelSceneTest, OneViewAloneAndNone) {
  views_.resize(1);
  views_[0].sources.clear();
  const SceneModel alone = *Run();
  EXPECT_GE(Find(room_.surfaces[0], alone), 0);
  EXPECT_EQ(alone.views.size(), 1u);
  views_.clear();
  const std::optional<SceneModel> none = Run();
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->planes.empty());
  EXPECT_TRUE(none->views.empty());
}

TEST_F(ModelSceneTest, StopsWhenAsked) {
  EXPECT_FALSE(Run([] { return true; }));
  int num_calls = 0;
  std::mutex mutex;
  EXPECT_FALSE(Run([&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return ++num_calls > 4;
  }));
}

// The middle view measures a wall too near, as fattening by a frame would have
// it, in a place where the others see the wall itself.
TEST_F(ModelSceneTest, ViewsThatDifferAgreeInTheEnd) {
  ViewEvidence& evidence = room_.evidence[0];
  // Half of the observations of some superpixels of the back wall lie on the
  // plane of the floor or on none.
  std::vector<size_t> doubtful;
  for (size_t k = 0; k < room_.seen[0].size(); k += 5) {
    if (room_.seen[0][k] != 0) {
      continue;
    }
    doubtful.push_back(k);
    for (int i = evidence.first_observation[k];
         i < evidence.first_observation[k + 1];
         ++i) {
      // 0.8 pixels of disparity in front of it.
      float& z = evidence.observations[i].sample.z;
      z *= 1.f - 0.8f * evidence.resolution.RelativeDepthError(z);
    }
  }
  ASSERT_GT(doubtful.size(), 3u);
  const SceneModel model = *Run();
  const int wall = Find(room_.surfaces[0], model);
  ASSERT_GE(wall, 0);
  for (const size_t k : doubtful) {
    EXPECT_EQ(model.views.at(kFirstImage).planes[k], wall) << k;
  }
}

}  // namespace
}  // namespace tsar
