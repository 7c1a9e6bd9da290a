// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/memory_plan.h"

#include "colmap_tsar/compose/compose_image.h"
#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/view/reduce_view.h"

#include <cstdint>
#include <vector>

#include "tests/run/counting_device.h"
#include "tests/support/find_scene_in.h"
#include "tests/support/image_evidence.h"
#include "tests/support/synthetic_views.h"
#include "tests/support/test_workspace.h"
#include <gmock/gmock.h>

namespace tsar {
namespace {

constexpr int64_t kGigabyte = 1000000000;

WorkspaceOverview OverviewOf(int64_t num_pixels, int num_sources) {
  WorkspaceOverview overview;
  overview.max_num_pixels = num_pixels;
  overview.max_num_image_pixels = num_pixels;
  overview.max_num_sources = num_sources;
  return overview;
}

// The memory of a device that refines an image, with its sources.
int64_t PeakOfRefinement(const SyntheticViews& drawn,
                         const RefineOptions& options) {
  CountingDevice device("", SIZE_MAX, 2);
  const auto sources = UploadViews(drawn.Sources(), device);
  if (!options.scene_planes) {
    RefineImage(drawn.views[0], sources, 1, options, device);
    return static_cast<int64_t>(device.PeakMemory());
  }
  const RefineResult observed =
      MakeImageEvidence(drawn.views[0], sources, 1, options, device);
  const std::vector<ObservedView> views(
      drawn.views.size(),
      MakeObservedView(*observed.evidence, drawn.views[0].camera));
  // The planes of the scene are found on the host.
  const std::unique_ptr<Device> host = Device::CreateCpu(1);
  ComposeImage(drawn.views[0],
               views,
               FindSceneIn(views, options, *host),
               options,
               device);
  return static_cast<int64_t>(device.PeakMemory());
}

TEST(PlanRefinement, IsAnUpperBoundOfWhatAnImageTakes) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the optimized build measures the same memory, in less time";
#endif
  // A map as large as its raster; a larger one; one with an oblong raster.
  for (const auto& [width, height] :
       {std::pair(161, 120), std::pair(840, 840), std::pair(801, 81)}) {
    SyntheticViewsOptions size;
    size.width = width;
    size.height = height;
    const SyntheticViews drawn = MakeSyntheticViews(size);
    for (const bool scene_planes : {true, false}) {
      for (const int superpixel_size : {100, 400, 1600}) {
        SCOPED_TRACE(std::to_string(width) + " pixels, superpixels of " +
                     std::to_string(superpixel_size));
        if (width == 840 && superpixel_size != 400) {
          continue;
        }
        RefineOptions options;
        options.scene_planes = scene_planes;
        options.superpixel_size = superpixel_size;
        const MemoryPlan plan = PlanRefinement(
            options,
            OverviewOf(int64_t{width} * height,
                       static_cast<int>(drawn.Sources().size())));
        const int64_t peak = PeakOfRefinement(drawn, options);
        EXPECT_GE(plan.device, peak);
        EXPECT_LE(plan.device, 2 * peak + (1 << 20));
      }
    }
  }
}

TEST(PlanRefinement, CountsReducedViewsWhereMapsAreLarge) {
  constexpr int64_t kJudged = int64_t{kMaxJudgingSide} * kMaxJudgingSide;
  const MemoryPlan plan = PlanRefinement({}, OverviewOf(kJudged, 10));
  EXPECT_EQ(plan.views, 11 * kJudged * kViewBytesPerPixel);
  // The sources of larger maps are as small; what is composed is not.
  const MemoryPlan larger = PlanRefinement({}, OverviewOf(4 * kJudged, 10));
  EXPECT_EQ(larger.views, plan.views);
  EXPECT_EQ(larger.model_block, plan.model_block);
  EXPECT_GT(larger.device, plan.device);
  const MemoryPlan huge = PlanRefinement({}, OverviewOf(100 * kJudged, 10));
  EXPECT_EQ(huge.views, 100 * kJudged * kViewBytesPerPixel);
  // Images that are refined by themselves are judged as they are.
  RefineOptions alone;
  alone.scene_planes = false;
  const MemoryPlan by_itself =
      PlanRefinement(alone, OverviewOf(4 * kJudged, 10));
  EXPECT_EQ(by_itself.views, 4 * plan.views);
  EXPECT_EQ(by_itself.model_block, 0);
  EXPECT_EQ(by_itself.label_view, 0);
}

TEST(PlanRefinement, CountsDepthPriors) {
  WorkspaceOverview overview = OverviewOf(1000000, 2);
  const MemoryPlan without = PlanRefinement({}, overview);
  overview.has_priors = true;
  EXPECT_EQ(PlanRefinement({}, overview).main, without.main + 16000000);
}

class FitIntoMainMemoryTest : public testing::Test {
 protected:
  FitIntoMainMemoryTest() {
    plan_.num_sources = 10;
    plan_.device = kGigabyte;
    plan_.main = 2 * kGigabyte;
    plan_.views = kGigabyte;
    wanted_.num_workers = 16;
    wanted_.num_threads = 18;
  }
  // Captures the warning.
  ImagesAtWork Fit(bool on_cpu, double cache_size) {
    testing::internal::CaptureStderr();
    const ImagesAtWork fit =
        FitIntoMainMemory(plan_, wanted_, on_cpu, cache_size, machine_bytes_);
    warning_ = testing::internal::GetCapturedStderr();
    return fit;
  }

  MemoryPlan plan_;
  ImagesAtWork wanted_;
  int64_t machine_bytes_ = 100 * kGigabyte;
  std::string warning_;
};

TEST_F(FitIntoMainMemoryTest, TakesFewerImagesWhereMemoryIsSmall) {
  for (const bool on_cpu : {true, false}) {
    for (const double cache_size : {3.0, 4.0, 6.5, 12.0, 31.0, 64.0}) {
      SCOPED_TRACE(cache_size);
      const ImagesAtWork fit = Fit(on_cpu, cache_size);
      EXPECT_EQ(warning_, "");
      const int64_t computing =
          on_cpu ? fit.num_workers * plan_.device : int64_t{0};
      EXPECT_LE(fit.num_threads * plan_.main + computing,
                static_cast<int64_t>(cache_size * kGigabyte));
      EXPECT_GE(fit.view_bytes, fit.num_threads * plan_.views);
      if (!on_cpu) {
        EXPECT_EQ(fit.num_workers, 16);
      }
    }
    EXPECT_EQ(Fit(on_cpu, 64.0).num_threads, 18);
    EXPECT_EQ(Fit(on_cpu, 64.0).num_workers, 16);
  }
}

TEST_F(FitIntoMainMemoryTest, LeavesAFifthOfTheMachinesMemory) {
  machine_bytes_ = 10 * kGigabyte;
  EXPECT_EQ(Fit(true, 32.0).num_workers, Fit(true, 8.0).num_workers);
  EXPECT_LT(Fit(true, 5.0).num_workers, Fit(true, 8.0).num_workers);
}

TEST_F(FitIntoMainMemoryTest, OneImageAloneIsWarnedOfOrRefused) {
  const ImagesAtWork fit = Fit(true, 0.25);
  EXPECT_EQ(fit.num_workers, 1);
  EXPECT_EQ(fit.num_threads, 1);
  EXPECT_THAT(warning_,
              testing::AllOf(testing::HasSubstr("with its 10 source images"),
                             testing::HasSubstr("needs 3.0 GB of main memory"),
                             testing::HasSubstr("0.3 GB"),
                             testing::HasSubstr("cache_size")));
  // If a GPU computes, less main memory is needed.
  Fit(false, 2.5);
  EXPECT_EQ(warning_, "");
  machine_bytes_ = kGigabyte;
  ExpectError(
      ErrorCode::kOutOfMemory,
      {"needs 3.0 GB of main memory",
       "this machine gives 1.0 GB;",
       "fewer source images",
       "--PatchMatchStereo.max_image_size"},
      [&] { FitIntoMainMemory(plan_, wanted_, true, 32.0, machine_bytes_); });
}

}  // namespace
}  // namespace tsar
