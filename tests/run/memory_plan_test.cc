// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/memory_plan.h"

#include "colmap_tsar/compose/compose_image.h"
#include "colmap_tsar/compose/stage_memory.h"
#include "colmap_tsar/run/device_view_cache.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/view/reduce_view.h"

#include <cstdint>
#include <vector>

#include "tests/run/counting_device.h"
#include "tests/support/find_scene_in.h"
#include "tests/support/observe_image.h"
#include "tests/support/synthetic_views.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

WorkspaceOverview OverviewOf(int64_t num_pixels, int num_sources) {
  WorkspaceOverview overview;
  overview.max_num_pixels = num_pixels;
  overview.max_num_image_pixels = num_pixels;
  overview.max_num_sources = num_sources;
  return overview;
}

TEST(PlanRefinement, CountsCosts) {
  WorkspaceOverview overview = OverviewOf(1000000, 2);
  const MemoryPlan plan = PlanRefinement({}, overview);
  // Maps are read in pieces; a photo is decoded as a whole, and then scaled.
  EXPECT_EQ(plan.load, 2 * 3 * overview.max_num_pixels);
  overview.has_costs = true;
  const MemoryPlan with_costs = PlanRefinement({}, overview);
  EXPECT_EQ(with_costs.view, plan.view + 8 * overview.max_num_pixels);
  EXPECT_EQ(with_costs.load, plan.load);
  EXPECT_EQ(with_costs.work, plan.work);
}

TEST(PlanRefinement, CountsPriors) {
  for (const int64_t num_pixels : {1000000, 10000000}) {
    WorkspaceOverview overview = OverviewOf(num_pixels, 2);
    const MemoryPlan plan = PlanRefinement({}, overview);
    overview.prior_memory = {5000, 1000};
    const MemoryPlan with_priors = PlanRefinement({}, overview);
    EXPECT_EQ(with_priors.view, plan.view + 5000);
    EXPECT_EQ(with_priors.whole_view,
              plan.whole_view + (plan.whole_view > 0 ? 5000 : 0));
    // A prior is read after the photo, which takes more.
    EXPECT_EQ(with_priors.load, plan.load);
    EXPECT_EQ(with_priors.work, plan.work);
    overview.prior_memory.to_read = 10 * num_pixels;
    EXPECT_EQ(PlanRefinement({}, overview).load, plan.load + 4 * num_pixels);
  }
}

TEST(PlanRefinement, CountsLabelImages) {
  RefineOptions alone;
  alone.scene_planes = false;
  WorkspaceOverview overview = OverviewOf(1000000, 2);
  const MemoryPlan plan = PlanRefinement(alone, overview);
  overview.max_num_label_pixels = 500000;
  const MemoryPlan small = PlanRefinement(alone, overview);
  EXPECT_EQ(small.view, plan.view + 2 * 500000);
  EXPECT_EQ(small.work, plan.work + SegmentsWorkingBytes(1000000));
  // They are read once the photo has been scaled.
  EXPECT_EQ(small.load, plan.load);
  // Large ones are decoded as a whole, and then reduced.
  overview.max_num_label_pixels = 4000000;
  const MemoryPlan large = PlanRefinement(alone, overview);
  EXPECT_EQ(large.view, plan.view + 2 * 1024 * 1024);
  EXPECT_EQ(large.load, 2 * 4000000);
  // Views that are reduced keep theirs.
  overview.max_num_pixels = 4000000;
  const MemoryPlan reduced = PlanRefinement({}, overview);
  overview.max_num_label_pixels = 0;
  EXPECT_EQ(reduced.view, PlanRefinement({}, overview).view + 2 * 1024 * 1024);
}

TEST(PlanRefinement, CountsEvidenceOfTheNeighborhoodsAtWork) {
  WorkspaceOverview overview = OverviewOf(1000000, 10);
  EXPECT_EQ(NumEvidenceViews(overview, 2), 33u);
  const MemoryPlan plan = PlanRefinement({}, overview);
  EXPECT_EQ(EvidenceBytes(plan, 2),
            33 * plan.neighbor_evidence + 2 * plan.own_evidence);
  // Larger maps have the same raster; only the own trust is of their size.
  overview.max_num_pixels += 500000;
  ASSERT_FALSE(HasReducedViews(overview));
  const MemoryPlan larger = PlanRefinement({}, overview);
  EXPECT_EQ(larger.neighbor_evidence, plan.neighbor_evidence);
  EXPECT_EQ(larger.own_evidence, plan.own_evidence + 500000);
  EXPECT_EQ(larger.model_block, plan.model_block);
  // Where planes end at creases, it is there twice.
  EXPECT_EQ(larger.label_view, plan.label_view + 2 * 500000);
  RefineOptions options;
  options.bounding_creases = false;
  EXPECT_EQ(PlanRefinement(options, overview).label_view,
            larger.label_view - larger.own_evidence);
}

TEST(PlanRefinement, CountsReducedViewsWhereMapsAreLarge) {
  constexpr int64_t kJudged = int64_t{kMaxJudgingSide} * kMaxJudgingSide;
  const MemoryPlan plan = PlanRefinement({}, OverviewOf(kJudged, 10));
  WorkspaceOverview overview = OverviewOf(kJudged + 1, 10);
  EXPECT_TRUE(HasReducedViews(overview));
  const MemoryPlan larger = PlanRefinement({}, overview);
  EXPECT_EQ(larger.view, plan.view);
  EXPECT_EQ(larger.uploaded_view, plan.uploaded_view);
  EXPECT_EQ(larger.make_evidence, plan.make_evidence);
  EXPECT_EQ(larger.neighbor_evidence, plan.neighbor_evidence);
  EXPECT_EQ(plan.whole_view, 0);
  EXPECT_EQ(larger.whole_view, ViewBytes(overview));
  // Whole views are never there at once.
  EXPECT_GT(larger.load, LoadBytes(overview));
  EXPECT_LT(larger.load, LoadBytes(overview) + larger.whole_view / 100);
  // Its sources are as small, whatever the size of the map.
  const MemoryPlan huge = PlanRefinement({}, OverviewOf(100000000, 10));
  EXPECT_EQ(huge.view, plan.view);
  EXPECT_EQ(huge.uploaded_view, plan.uploaded_view);
  EXPECT_EQ(BytesForViews(huge), huge.whole_view);
  EXPECT_GT(huge.work, larger.work);
  // A long map may have few pixels.
  overview = OverviewOf(100000, 10);
  EXPECT_FALSE(HasReducedViews(overview));
  overview.max_side = kMaxJudgingSide + 1;
  EXPECT_TRUE(HasReducedViews(overview));
  EXPECT_EQ(PlanRefinement({}, overview).view,
            PlanRefinement({}, OverviewOf(100000, 10)).view);
  // Images that are refined by themselves are judged as they are.
  RefineOptions alone;
  alone.scene_planes = false;
  overview = OverviewOf(10000000, 10);
  EXPECT_EQ(PlanRefinement(alone, overview).view, ViewBytes(overview));
  EXPECT_EQ(PlanRefinement(alone, overview).whole_view, 0);
  EXPECT_EQ(PlanRefinement(alone, overview).load, LoadBytes(overview));
}

TEST(PlanRefinement, CountsLabelsAsAPartOfTheWork) {
  for (const int num_sources : {1, 10, 40}) {
    const MemoryPlan plan = PlanRefinement({}, OverviewOf(300000, num_sources));
    EXPECT_GT(plan.label_work, 0);
    EXPECT_LE(plan.label_work, plan.work);
    const MemoryPlan labels = ForLabelsAlone(plan);
    EXPECT_EQ(DeviceBytes(labels, 2), 2 * plan.label_work);
    EXPECT_EQ(SharedViewBytes(labels, 2), 0);
    EXPECT_EQ(labels.label_view, plan.label_view);
  }
}

TEST(PlanRefinement, CountsNoEvidenceWhereEachImageIsAlone) {
  for (bool RefineOptions::*option :
       {&RefineOptions::scene_planes, &RefineOptions::refine}) {
    RefineOptions options;
    options.*option = false;
    const MemoryPlan plan = PlanRefinement(options, OverviewOf(1000000, 10));
    EXPECT_GT(plan.work, 0);
    EXPECT_EQ(plan.label_work + plan.model_block + plan.label_view +
                  plan.make_evidence + EvidenceBytes(plan, 3),
              0);
  }
}

TEST(PlanRefinement, BoundsTheScoresOfPlanes) {
  const MemoryPlan plan = PlanRefinement({}, OverviewOf(300000, 10));
  // Blocks are as large for any number of sources; a view hears all of its own.
  EXPECT_EQ(PlanRefinement({}, OverviewOf(300000, 5)).model_block,
            plan.model_block);
  EXPECT_LT(PlanRefinement({}, OverviewOf(300000, 5)).label_view,
            plan.label_view);
  // Whatever the candidates.
  EXPECT_LT(PlanRefinement({}, OverviewOf(10000000, 50)).model_block,
            4 * static_cast<int64_t>(kMaxBlockScores) + (int64_t{1} << 30));
}

// Observes and composes an image, with its sources in a cache that holds as
// much as it may.
int64_t PeakOfRefinement(const SyntheticViews& drawn,
                         const RefineOptions& options,
                         const MemoryPlan& plan) {
  CountingDevice device("", SIZE_MAX, 2);
  DeviceViewCache cache(static_cast<size_t>(SharedViewBytes(plan, 1)));
  // A view of the image before.
  cache.Get(-1, drawn.views[0], device);
  std::vector<DeviceViewCache::View> sources;
  for (const ViewData* source : drawn.Sources()) {
    sources.push_back(
        cache.Get(static_cast<int>(sources.size()), *source, device));
  }
  const RefineResult observed =
      ObserveImage(drawn.views[0], sources, 1, options, device);
  const ViewEvidence& evidence = *observed.evidence;
  const std::vector<ObservedView> views(
      drawn.views.size(), MakeObservedView(evidence, drawn.views[0].camera));
  // The planes of the scene are found on the host.
  const std::unique_ptr<Device> host = Device::CreateCpu(1);
  ComposeImage(drawn.views[0],
               sources,
               views,
               FindSceneIn(views, options, *host),
               options,
               device);
  return static_cast<int64_t>(device.PeakMemory());
}

TEST(PlanRefinement, HoldsForAnImageAtWork) {
  for (const auto& [width, height] : {std::pair{161, 120}, {320, 240}}) {
    SCOPED_TRACE(width);
    SyntheticViewsOptions size;
    size.width = width;
    size.height = height;
    const SyntheticViews drawn = MakeSyntheticViews(size);
    for (const int superpixel_size : {100, 400, 1600}) {
      SCOPED_TRACE(superpixel_size);
      RefineOptions options;
      options.superpixel_size = superpixel_size;
      const MemoryPlan plan =
          PlanRefinement(options,
                         OverviewOf(int64_t{width} * height,
                                    static_cast<int>(drawn.Sources().size())));
      const int64_t peak = PeakOfRefinement(drawn, options, plan);
      EXPECT_GE(DeviceBytes(plan, 1), peak);
      EXPECT_LE(DeviceBytes(plan, 1), 1.5 * peak);
      RecordProperty("percent_" + std::to_string(width) + "_" +
                         std::to_string(superpixel_size),
                     static_cast<int>(100 * DeviceBytes(plan, 1) / peak));
    }
  }
}

}  // namespace
}  // namespace tsar
