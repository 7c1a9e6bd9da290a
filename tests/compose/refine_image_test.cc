// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/refine_image.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "tests/run/counting_device.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_views_test.h"
#include "tests/support/test_device.h"

namespace tsar {
namespace {

class RefineImageTest : public SyntheticViewsTest {
 protected:
  RefineResult Refine(const RefineOptions& options = {}) const {
    return RefineImage(drawn_.views[0],
                       UploadViews(drawn_.Sources(), *device_),
                       1,
                       options,
                       *device_);
  }
};

TEST_F(RefineImageTest, FillsTheBarePartWithTheWall) {
  const RefineResult result = Refine();
  EXPECT_EQ(result.reason_to_keep, "");
  ExpectSoundMaps(result.maps);
  ExpectBarePartIsFilled(result.maps);
}

TEST_F(RefineImageTest, NoDepthThatWasRightByAMarginGetsWrong) {
  const Image<float> after = Refine().maps.depth;
  double error_before = 0.0;
  double error_after = 0.0;
  int count = 0;
  int num_lost = 0;
  ForEachPixel(after.Width(), after.Height(), [&](int x, int y) {
    if (RelativeError(Before(), x, y) > 2e-3f) {
      return;
    }
    ++count;
    if (!(after(x, y) > 0.f)) {
      ++num_lost;
      return;
    }
    ASSERT_LT(RelativeError(after, x, y), 5e-3f) << x << ", " << y;
    error_before += RelativeError(Before(), x, y);
    error_after += RelativeError(after, x, y);
  });
  ASSERT_GT(count, 4000);
  EXPECT_LT(num_lost, 0.02 * count);
  EXPECT_LE(error_after, error_before);
}

TEST_F(RefineImageTest, APlaneStaysAPlane) {
  SyntheticViewsOptions options;
  options.has_bare_part = false;
  options.noise = 0.f;
  drawn_ = MakeSyntheticViews(options);
  const RefinedMaps maps = Refine().maps;
  ExpectSoundMaps(maps);
  int num_filled = 0;
  ForEachPixel(maps.depth.Width(), maps.depth.Height(), [&](int x, int y) {
    if (maps.depth(x, y) > 0.f) {
      ++num_filled;
      ASSERT_LT(RelativeError(maps.depth, x, y), 1e-3f) << x << ", " << y;
      ASSERT_LT(AngleBetween(maps.normal(x, y), drawn_.wall.normal), 0.5f)
          << x << ", " << y;
    }
  });
  EXPECT_GT(num_filled, 0.99 * maps.depth.NumPixels());
}

TEST_F(RefineImageTest, EverySwitchLeavesSoundMaps) {
  ExpectSoundMapsOfEverySwitch(
      [&](const RefineOptions& options) { return Refine(options); });
  SCOPED_TRACE("paper");
  const RefineResult paper = Refine(PresetOptions(RefinePreset::kPaper));
  ExpectSoundMaps(paper.maps);
  EXPECT_EQ(paper.reason_to_keep, "");
}

TEST_F(RefineImageTest, WithoutAnyStageKeepsTheDepths) {
  RefineOptions options;
  options.filter = false;
  options.refine = false;
  options.segment = false;
  const RefinedMaps maps = Refine(options).maps;
  int num_kept = 0;
  for (size_t i = 0; i < Before().NumPixels(); ++i) {
    const float depth = maps.depth.Data()[i];
    ASSERT_TRUE(depth == 0.f || depth == Before().Data()[i]) << i;
    num_kept += depth > 0.f ? 1 : 0;
  }
  EXPECT_GT(num_kept, 4000);
}

TEST_F(RefineImageTest, TheEvidenceHoldsTheImageWithItsNoiseAndWithout) {
  Image<Rgb>& color = drawn_.views[0].color;
  Philox random(2, 0, 0);
  for (Rgb& pixel : color) {
    const auto gray = static_cast<uint8_t>(pixel.r + 9.f * random.NextFloat());
    pixel = {gray, gray, gray};
  }
  const std::unique_ptr<ViewEvidence> evidence = std::move(Observe(1)[0]);
  ASSERT_TRUE(evidence->gray.HasSizeOf(color));
  int num_changed = 0;
  ForEachPixel(color.Width(), color.Height(), [&](int x, int y) {
    EXPECT_EQ(evidence->gray(x, y), color(x, y).r);
    num_changed += evidence->color(x, y).r != color(x, y).r;
  });
  EXPECT_GT(num_changed, static_cast<int>(color.NumPixels() / 4));
}

TEST_F(RefineImageTest, TakesTheCostsThatComeWithTheMaps) {
  // Only the costs decide which pixels are reliable.
  RefineOptions options;
  options.view_agreement = false;
  options.filter_discontinuity = false;
  EXPECT_EQ(Refine(options).reason_to_keep, "");
  ViewData& reference = drawn_.views[0];
  const int width = reference.depth.Width();
  const int height = reference.depth.Height();
  reference.min_cost = Image<float>(width, height, kUndefinedCost);
  EXPECT_NE(Refine(options).reason_to_keep, "");
  // Nor with the worst costs.
  reference.min_cost = Image<float>(width, height, 1.99f);
  EXPECT_NE(Refine(options).reason_to_keep, "");
  reference.min_cost = Image<float>(width, height, 0.f);
  EXPECT_EQ(Refine(options).reason_to_keep, "");
}

// A GPU that knows whether it may have pending work, and runs out of memory on
// request.
class BusyDevice : public CountingDevice {
 public:
  BusyDevice() : CountingDevice("Card", size_t{1} << 30, 2) {}

  void* Allocate(size_t num_bytes) override {
    is_busy_ = true;
    if (NumAllocations() == num_good_allocations) {
      throw Error(ErrorCode::kOutOfMemory, "GPU: it is full; empty it");
    }
    return CountingDevice::Allocate(num_bytes);
  }
  void Synchronize() override { is_busy_ = false; }
  bool IsBusy() const { return is_busy_; }

  int num_good_allocations = -1;

 private:
  bool is_busy_ = false;
};

TEST_F(RefineImageTest, SourcesStayUntilTheDeviceIsDoneWithThem) {
  const auto cpu = Device::CreateCpu(1);
  int num_gone = 0;
  // Returns the number of allocations.
  const auto refine = [&](int num_good_allocations) {
    BusyDevice device;
    device.num_good_allocations = num_good_allocations;
    std::vector<std::shared_ptr<const UploadedView>> sources;
    for (const auto& source : UploadViews(drawn_.Sources(), *cpu)) {
      sources.emplace_back(source.get(), [&, source](const UploadedView*) {
        ++num_gone;
        EXPECT_FALSE(device.IsBusy()) << num_good_allocations;
      });
    }
    const auto run = [&] {
      RefineImage(drawn_.views[0], std::move(sources), 1, {}, device);
    };
    if (num_good_allocations < 0) {
      run();
    } else {
      EXPECT_THROW(run(), Error);
    }
    return device.NumAllocations();
  };
  const int num_allocations = refine(-1);
  EXPECT_EQ(num_gone, 4);
  // Until these are uploaded, nothing reads the sources.
  BusyDevice device;
  const DeviceViews views(drawn_.views[0], UploadViews({}, device), device);
  int num_failures = 0;
  for (int i = device.NumAllocations() + 1; i < num_allocations; i += 7) {
    num_gone = 0;
    refine(i);
    EXPECT_EQ(num_gone, 4);
    ++num_failures;
  }
  EXPECT_GT(num_failures, 10);
}

}  // namespace
}  // namespace tsar
