// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/refine_devices.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/pipeline/memory_plan.h"

#include <map>
#include <set>

#include "tests/pipeline/counting_device.h"
#include "tests/pipeline/drawn_views.h"
#include "tests/workspace/test_workspace.h"

namespace tsar {
namespace {

constexpr size_t kGigabyte = 1000000000;

class RefineDevicesTest : public testing::Test {
 protected:
  RefineDevicesTest() {
    overview_.max_num_pixels = 1000000;
    overview_.max_num_sources = 10;
    options_.num_threads = 16;
  }

  GpuSystem Gpus(int num_gpus) {
    return {num_gpus, [this](int index, int num_threads) {
              if (without_code_.count(index) > 0 || index < 0) {
                throw Error(
                    ErrorCode::kDevice,
                    "GPU " + std::to_string(index) + " has no code; build it");
              }
              const size_t memory =
                  memory_.count(index) > 0 ? memory_[index] : 8 * kGigabyte;
              return std::unique_ptr<Device>(
                  new CountingDevice("Card", memory, num_threads));
            }};
  }
  RefineDevices Create(int num_gpus, int num_images = 100) {
    return CreateRefineDevices(options_, overview_, num_images, Gpus(num_gpus));
  }
  void ExpectRefusal(ErrorCode code,
                     const std::vector<std::string>& texts,
                     int num_gpus) {
    ExpectError(code, texts, [&] { Create(num_gpus); });
  }

  WorkspaceOverview overview_;
  WorkspaceRefineOptions options_;
  std::map<int, size_t> memory_;
  std::set<int> without_code_;
};

TEST_F(RefineDevicesTest, TakesEveryGpuWithTwoWorkers) {
  const RefineDevices devices = Create(2);
  ASSERT_EQ(devices.workers.size(), 4u);
  EXPECT_EQ(devices.workers[0].name, "GPU 0 (Card)");
  EXPECT_EQ(devices.workers[1].name, "GPU 0 (Card)");
  EXPECT_EQ(devices.workers[3].name, "GPU 1 (Card)");
  EXPECT_EQ(devices.workers[0].views, devices.workers[1].views);
  EXPECT_NE(devices.workers[1].views, devices.workers[2].views);
  EXPECT_NE(devices.workers[0].device, devices.workers[1].device);
  EXPECT_EQ(devices.description, "GPU 0 (Card), GPU 1 (Card)");
  EXPECT_GT(devices.sizes.num_loaders, 1);
}

TEST_F(RefineDevicesTest, TakesTheNamedGpusInTheirOrder) {
  options_.gpu_index = "2,0";
  EXPECT_EQ(Create(3).description, "GPU 2 (Card), GPU 0 (Card)");
  options_.gpu_index = "0,3";
  ExpectRefusal(
      ErrorCode::kDevice, {"gpu_index", "no GPU 3", "has 3", "0 to 2"}, 3);
  options_.gpu_index = "1";
  ExpectRefusal(ErrorCode::kDevice, {"gpu_index", "no GPU 1", "number 0"}, 1);
}

TEST_F(RefineDevicesTest, LeavesOutGpusWithoutCodeUnlessNamed) {
  without_code_ = {0};
  EXPECT_EQ(Create(2).description, "GPU 1 (Card)");
  options_.gpu_index = "0,1";
  ExpectRefusal(ErrorCode::kDevice, {"GPU 0 has no code"}, 2);
}

TEST_F(RefineDevicesTest, WithoutAnyGpuAutoMeansTheCpu) {
  without_code_ = {0, 1};
  options_.device = "auto";
  EXPECT_EQ(Create(2).description, "16 CPU threads");
  EXPECT_EQ(Create(0).description, "16 CPU threads");
  options_.device = "cpu";
  EXPECT_EQ(Create(3).description, "16 CPU threads");
  options_.device = "cuda";
  ExpectRefusal(ErrorCode::kDevice, {"GPU 0 has no code"}, 2);
  ExpectRefusal(ErrorCode::kDevice, {"GPU 0 has no code"}, 0);
}

TEST_F(RefineDevicesTest, UsesOneWorkerWhereTwoDoNotFit) {
  memory_[0] = static_cast<size_t>(WorkBytes(overview_)) * 3 / 2;
  EXPECT_EQ(Create(1).workers.size(), 1u);
  EXPECT_EQ(Create(2).workers.size(), 3u);
}

TEST_F(RefineDevicesTest, SaysWhatAnImageNeedsWhereNoneFits) {
  overview_.max_num_pixels = 20000000;
  memory_[0] = 2 * kGigabyte;
  const std::vector<std::string> texts = {"GPU 0 (Card)",
                                          "needs 2.7 GB",
                                          "2.0 GB are free",
                                          "close other programs",
                                          "gpu_index",
                                          "max_image_size",
                                          "device cpu"};
  ExpectRefusal(ErrorCode::kDevice, texts, 1);
  // Another has enough.
  EXPECT_EQ(Create(2).description, "GPU 1 (Card)");
  options_.gpu_index = "0,1";
  ExpectRefusal(ErrorCode::kDevice, texts, 2);
}

TEST_F(RefineDevicesTest, NoMoreWorkersThanImages) {
  EXPECT_EQ(Create(1, 1).workers.size(), 1u);
  options_.device = "cpu";
  EXPECT_EQ(Create(1, 3).workers.size(), 3u);
}

TEST_F(RefineDevicesTest, AllMemoryTogetherIsTheCacheSize) {
  for (const char* device : {"cpu", "cuda"}) {
    options_.device = device;
    for (const double cache_size : {0.001, 1.0, 8.0}) {
      options_.cache_size = cache_size;
      const RefineDevices devices = Create(2);
      const auto num_results =
          static_cast<int64_t>(devices.workers.size() +
                               devices.sizes.max_finished) +
          devices.sizes.num_writers;
      const auto work = options_.device == "cpu"
                            ? WorkBytes(overview_) *
                                  static_cast<int64_t>(devices.workers.size())
                            : 0;
      const auto fixed = work + num_results * ResultBytes(overview_);
      EXPECT_LE(
          static_cast<int64_t>(devices.cache_num_bytes),
          std::max<int64_t>(0, static_cast<int64_t>(cache_size * 1e9) - fixed));
      EXPECT_EQ(devices.cache_num_bytes == 0, cache_size == 0.001);
    }
  }
}

// What the plan says that a worker needs, against what it takes.
TEST(WorkBytes, HoldsForAnImage) {
  // As large as the reduced raster, and larger.
  for (const auto& [width, height] : {std::pair{640, 480}, {1001, 301}}) {
    DrawnViewsOptions options;
    options.width = width;
    options.height = height;
    const DrawnViews drawn = DrawViews(options);
    WorkspaceOverview overview;
    overview.max_num_pixels = int64_t{width} * height;
    overview.max_num_sources = static_cast<int>(drawn.Sources().size());
    CountingDevice device("", SIZE_MAX, 2);
    RefineImage(drawn.views[0], drawn.Sources(), 1, {}, device);
    EXPECT_LE(static_cast<int64_t>(device.PeakMemory()), WorkBytes(overview));
    EXPECT_GE(static_cast<int64_t>(device.PeakMemory()),
              WorkBytes(overview) / 2);
  }
}

}  // namespace
}  // namespace tsar
