// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/stage_memory.h"

#include "colmap_tsar/compose/compose_image.h"
#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/view/reduce_view.h"
#include "colmap_tsar/view/refine_option_list.h"
#include "colmap_tsar/view/view_data.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/run/counting_device.h"
#include "tests/support/find_scene_in.h"
#include "tests/support/observe_image.h"
#include "tests/support/synthetic_views.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// What the plan may say at most, times what is taken: with the default options,
// and with others, whose stages it does not tell apart.
constexpr double kMaxRatio = 1.5;
constexpr double kMaxRatioOfOthers = 2.0;

struct MapSize {
  int width;
  int height;
};

// As large as its raster, and so small that the accumulator of lines counts.
const MapSize kSmall = {161, 120};
// Larger than its raster.
const MapSize kLarge = {840, 840};
// The plan knows the number of pixels alone, and takes the raster to be square.
const MapSize kLong = {801, 81};

// What a function takes of a device's memory, with the sources gone when it
// lets them go.
int64_t PeakOf(const std::function<void(Device&)>& function) {
  CountingDevice device("", SIZE_MAX, 2);
  function(device);
  return static_cast<int64_t>(device.PeakMemory());
}

class StageMemoryTest : public testing::Test {
 protected:
  void SetUp() override {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP()
        << "the optimized build measures the same memory, in less time";
#endif
  }

  void Draw(const MapSize& size) {
    SyntheticViewsOptions drawn;
    drawn.width = size.width;
    drawn.height = size.height;
    drawn_ = MakeSyntheticViews(drawn);
    num_pixels_ = int64_t{size.width} * size.height;
    label_ = std::to_string(size.width);
  }

  // name: of the ratio in the test's record.
  void ExpectPlanned(const std::string& name, int64_t planned, int64_t taken) {
    EXPECT_GE(planned, taken) << name;
    EXPECT_LE(planned, max_ratio_ * taken) << name;
    RecordProperty(
        name + " of " + label_,
        std::to_string(100 * planned / std::max<int64_t>(1, taken)) + " %");
  }

  // The sources are uploaded to another device: they do not count.
  int64_t PeakBesideSources(
      const std::function<void(std::vector<std::shared_ptr<const UploadedView>>,
                               Device&)>& function) {
    const std::unique_ptr<Device> other = Device::CreateCpu(1);
    return PeakOf([&](Device& device) {
      function(UploadViews(drawn_.Sources(), *other), device);
    });
  }

  void ExpectSingleViewPlanned(const RefineOptions& options) {
    ExpectPlanned(
        "refine",
        RefineImageWorkingBytes(options, num_pixels_),
        PeakBesideSources([&](auto sources, Device& device) {
          RefineImage(drawn_.views[0], std::move(sources), 1, options, device);
        }));
  }

  void ExpectScenePlanned(const RefineOptions& options) {
    RefineResult observed;
    ExpectPlanned(
        "measure",
        MeasureImageWorkingBytes(options, num_pixels_),
        PeakBesideSources([&](auto sources, Device& device) {
          observed = MeasureImage(
              drawn_.views[0], std::move(sources), 1, options, device);
        }));
    EXPECT_LE(PeakOf([&](Device& device) {
                MakeEvidence(options, device, &observed);
              }),
              MakeEvidenceMainBytes(options, num_pixels_));
    const ViewEvidence& evidence = *observed.evidence;
    // As many views as there are, for the size of the tables.
    const std::vector<ObservedView> views(
        drawn_.views.size(),
        MakeObservedView(evidence, drawn_.views[0].camera));
    const int num_views = static_cast<int>(views.size());
    EXPECT_LE(
        PeakOf([&](Device& device) { ModelBlock(views, options, device); }),
        ModelBlockMainBytes(options, num_pixels_, num_views));
    const std::unique_ptr<Device> block_device = Device::CreateCpu(1);
    const BlockOfScene block = ModelBlock(views, options, *block_device);
    ExpectLabelsPlanned(views, block, options);
    FoundScene found;
    EXPECT_LE(PeakOf([&](Device& device) {
                found = FindSceneOfBlock(views, block, options, device);
              }),
              LabelViewMainBytes(options, num_pixels_, num_views));
    ExpectPlanned(
        "compose",
        ComposeImageWorkingBytes(options, num_pixels_, num_pixels_),
        PeakBesideSources([&](auto sources, Device& device) {
          ComposeImage(drawn_.views[0], sources, views, found, options, device);
        }));
  }

  // Of the device that is lent, without costs and with those of a former call.
  void ExpectLabelsPlanned(const std::vector<ObservedView>& views,
                           const BlockOfScene& block,
                           const RefineOptions& options) {
    std::vector<ModelPlane> planes;
    for (const MeasuredScenePlane& plane : block.planes) {
      planes.push_back(ToModelPlane(plane));
    }
    std::vector<ModeledView> modeled;
    for (size_t i = 0; i < views.size(); ++i) {
      modeled.push_back({views[i], &block.assignment[i]});
    }
    const DeviceLender lend_device =
        [](int64_t planned, const std::function<void(Device&)>& work) {
          EXPECT_LE(PeakOf(work), planned);
        };
    Image<PlaneCost> costs;
    const LabelsInModel labels =
        LabelInModel(modeled, planes, {}, options, lend_device, &costs);
    for (ModeledView& view : modeled) {
      view.labels = &labels;
    }
    LabelInModel(modeled, planes, {}, options, lend_device, &costs);
    costs = {};
    LabelInModel(modeled, planes, {}, options, lend_device, &costs);
  }

  SyntheticViews drawn_;
  int64_t num_pixels_ = 0;
  double max_ratio_ = kMaxRatio;
  std::string label_;  // For the test's record.
};

TEST_F(StageMemoryTest, HoldsForMapsOfAllShapes) {
  for (const MapSize& size : {kSmall, kLarge, kLong}) {
    SCOPED_TRACE(std::to_string(size.width));
    Draw(size);
    ExpectScenePlanned({});
    if (size.width < kLarge.width) {
      ExpectSingleViewPlanned({});
    }
  }
}

TEST_F(StageMemoryTest, HoldsForMapsThatAreJudgedAtASmallerSize) {
  Draw({480, 360});
  const SyntheticViews whole = drawn_;
  for (const int factor : {2, 5}) {
    SCOPED_TRACE(factor);
    label_ = "reduced by " + std::to_string(factor);
    drawn_ = whole;
    for (ViewData& view : drawn_.views) {
      view = ReduceView(view, factor);
    }
    const ViewData& judged = drawn_.views[0];
    const auto num_judged = static_cast<int64_t>(judged.depth.NumPixels());
    const RefineOptions options;
    const std::unique_ptr<Device> device = Device::CreateCpu(2);
    const RefineResult observed = ObserveImage(
        judged, UploadViews(drawn_.Sources(), *device), 1, options, *device);
    const ViewEvidence& evidence = *observed.evidence;
    const std::vector<ObservedView> views = {
        MakeObservedView(evidence, judged.camera)};
    const FoundScene found = FindSceneIn(views, options, *device);
    ExpectPlanned("compose",
                  ComposeImageWorkingBytes(options, num_pixels_, num_judged),
                  PeakOf([&](Device& counting) {
                    ComposeImage(
                        whole.views[0], {}, views, found, options, counting);
                  }));
  }
}

TEST_F(StageMemoryTest, HoldsForThePaper) {
  max_ratio_ = kMaxRatioOfOthers;
  for (const MapSize& size : {kSmall, kLarge, kLong}) {
    SCOPED_TRACE(std::to_string(size.width));
    Draw(size);
    ExpectSingleViewPlanned(PresetOptions(RefinePreset::kPaper));
  }
  Draw(kSmall);
  RefineOptions options = PresetOptions(RefinePreset::kPaper);
  options.scene_planes = true;
  ExpectScenePlanned(options);
}

TEST_F(StageMemoryTest, HoldsForSuperpixelsOfAllSizes) {
  max_ratio_ = kMaxRatioOfOthers;
  Draw(kSmall);
  for (const int superpixel_size : {25, 400, 10000}) {
    SCOPED_TRACE(superpixel_size);
    label_ = "superpixels of " + std::to_string(superpixel_size);
    RefineOptions options;
    options.superpixel_size = superpixel_size;
    ExpectSingleViewPlanned(options);
    ExpectScenePlanned(options);
  }
}

TEST_F(StageMemoryTest, HoldsWithoutSomeOfTheStages) {
  max_ratio_ = kMaxRatioOfOthers;
  Draw(kSmall);
  // What a stage does not take is planned all the same.
  const std::vector<std::vector<bool RefineOptions::*>> switches = {
      {&RefineOptions::segment},
      {&RefineOptions::segment, &RefineOptions::weighted_median},
      {&RefineOptions::segment, &RefineOptions::superpixel_planes},
      {&RefineOptions::segment, &RefineOptions::filter_discontinuity}};
  for (size_t i = 0; i < switches.size(); ++i) {
    SCOPED_TRACE(i);
    label_ = "choice " + std::to_string(i);
    RefineOptions options;
    for (bool RefineOptions::*option : switches[i]) {
      options.*option = false;
    }
    ExpectSingleViewPlanned(options);
  }
  RefineOptions options;
  options.pixel_borders = false;
  options.weighted_median = false;
  ExpectScenePlanned(options);
}

TEST_F(StageMemoryTest, CountsTheEvidenceOfAView) {
  max_ratio_ = kMaxRatioOfOthers;
  Draw(kSmall);
  for (const int superpixel_size : {40, 400, 10000}) {
    SCOPED_TRACE(superpixel_size);
    label_ = std::to_string(superpixel_size);
    RefineOptions options;
    options.superpixel_size = superpixel_size;
    const std::unique_ptr<Device> device = Device::CreateCpu(2);
    const RefineResult observed =
        ObserveImage(drawn_.views[0],
                     UploadViews(drawn_.Sources(), *device),
                     1,
                     options,
                     *device);
    const ViewEvidence& evidence = *observed.evidence;
    const size_t for_neighbors =
        evidence.superpixels.NumPixels() * sizeof(uint16_t) +
        evidence.confident_depth.NumPixels() * sizeof(float) +
        evidence.weights.size() * sizeof(float) +
        evidence.first_observation.size() * sizeof(int) +
        evidence.observations.size() * sizeof(Observation);
    ExpectPlanned("neighbor",
                  NeighborEvidenceBytes(options, num_pixels_),
                  static_cast<int64_t>(for_neighbors));
    const size_t all =
        for_neighbors + evidence.sources.size() +
        // Hardly a depth of this scene is confirmed and not trusted.
        std::min<size_t>(evidence.superpixels.NumPixels(),
                         static_cast<size_t>(evidence.NumSuperpixels() *
                                             kMaxConfirmedPerSuperpixel)) *
            sizeof(RayDepth) +
        2 * evidence.confirmed_pixels.size() * sizeof(int) +
        evidence.borders.size() * sizeof(SuperpixelBorder) +
        evidence.color.NumPixels() * sizeof(Rgb) + evidence.flags.NumPixels();
    ExpectPlanned("all",
                  ViewEvidenceBytes(options, num_pixels_),
                  static_cast<int64_t>(all));
  }
}

}  // namespace
}  // namespace tsar
