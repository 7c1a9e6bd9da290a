// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_devices.h"

#include "colmap_tsar/scene/find_scene.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/run/refine_devices_fixture.h"
#include <gmock/gmock.h>

namespace tsar {
namespace {

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

TEST_F(RefineDevicesTest, WithoutAnyGpuAutoMeansTheCpu) {
  without_code_ = {0, 1};
  options_.choice = DeviceChoice::kAuto;
  EXPECT_EQ(Create(2).description, "16 CPU threads");
  EXPECT_EQ(Create(0).description, "16 CPU threads");
  options_.gpu_indices = {0};
  testing::internal::CaptureStderr();
  EXPECT_EQ(Create(0).description, "16 CPU threads");
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("gpu_index: there is no GPU that can be used; "
                                 "going on with the CPU"));
  options_.gpu_indices = {};
  options_.choice = DeviceChoice::kCpu;
  EXPECT_EQ(Create(3).description, "16 CPU threads");
  options_.choice = DeviceChoice::kCuda;
  ExpectRefusal(ErrorCode::kDevice, {"GPU 0 has no code"}, 2);
  ExpectRefusal(ErrorCode::kDevice, {"GPU 0 has no code"}, 0);
}

TEST_F(RefineDevicesTest, TheModelPassHasTheGpusOfTheWorkers) {
  const RefineDevices devices = Create(2);
  ASSERT_EQ(devices.model.gpus.size(), devices.workers.size());
  for (size_t i = 0; i < devices.workers.size(); ++i) {
    EXPECT_EQ(devices.model.gpus[i].name, devices.workers[i].name);
    EXPECT_EQ(devices.model.gpus[i].device, devices.workers[i].device.get());
  }
  EXPECT_GE(devices.model.max_gpu_bytes, Plan().work);
  EXPECT_EQ(Create(2, 2).model.max_gpu_bytes, Plan().work);
  options_.choice = DeviceChoice::kCpu;
  EXPECT_TRUE(Create(2).model.gpus.empty());
}

TEST_F(RefineDevicesTest, WhatTheModelPassKeepsIsWhatIsLeftOfMainMemory) {
  options_.choice = DeviceChoice::kCpu;
  const ModelResources model = Create(0).model;
  EXPECT_EQ(model.num_views, 16);
  EXPECT_EQ(model.max_kept_bytes + 16 * Plan().label_view,
            static_cast<int64_t>(options_.cache_size * kGigabyte));
  // No view is labeled beside another one, and nothing is left.
  options_.cache_size = 0.001;
  EXPECT_EQ(PlanModelPass(options_, Plan(), machine_bytes_).num_views, 1);
  EXPECT_EQ(PlanModelPass(options_, Plan(), machine_bytes_).max_kept_bytes, 0);
}

TEST_F(RefineDevicesTest, GpusCanRateTheLabelsOfMostViews) {
  for (const int64_t num_pixels : {300000, 1500000, 6400000}) {
    for (const int num_sources : {10, 20}) {
      overview_.max_num_pixels = num_pixels;
      overview_.max_num_sources = num_sources;
      LabelingSize size;
      size.num_views = num_sources + 1;
      size.num_pixels = std::min<int64_t>(num_pixels, 777 * 777);
      size.num_superpixels = size.num_pixels / 350;
      size.num_observations = 32 * size.num_superpixels;
      size.num_planes = 80;
      EXPECT_LE(LabelInModelWorkingBytes(
                    size, {/*confident_depth=*/true, /*superpixels=*/true}),
                Create(1).model.max_gpu_bytes)
          << num_pixels << " " << num_sources;
    }
  }
}

TEST_F(RefineDevicesTest, NoMoreWorkersThanImages) {
  for (int num_gpus = 1; num_gpus <= 4; ++num_gpus) {
    for (int num_images = 1; num_images <= 10; ++num_images) {
      const RefineDevices devices = Create(num_gpus, num_images);
      EXPECT_EQ(static_cast<int>(devices.workers.size()),
                std::min(num_images, kMaxGpuWorkers * num_gpus));
      // Of the GPUs that get no image none is opened.
      EXPECT_EQ(static_cast<int>(num_created_.size()),
                std::min(num_images, num_gpus));
      EXPECT_EQ(devices.view_caches.size(), num_created_.size());
    }
  }
  options_.choice = DeviceChoice::kCpu;
  EXPECT_EQ(Create(1, 3).workers.size(), 3u);
}

TEST_F(RefineDevicesTest, EveryGpuGetsAnImageBeforeOneGetsTwo) {
  EXPECT_EQ(Names(Create(2, 2)),
            std::vector<std::string>({"GPU 0 (Card)", "GPU 1 (Card)"}));
  EXPECT_EQ(Names(Create(2, 3)),
            std::vector<std::string>(
                {"GPU 0 (Card)", "GPU 0 (Card)", "GPU 1 (Card)"}));
  // The next takes the place of one that cannot be used.
  without_code_ = {0};
  memory_[1] = 1;
  EXPECT_EQ(Names(Create(4, 1)), std::vector<std::string>({"GPU 2 (Card)"}));
  memory_[2] = static_cast<size_t>(DeviceBytes(Plan(), 1)) * 3 / 2;
  EXPECT_EQ(Names(Create(4, 3)),
            std::vector<std::string>(
                {"GPU 2 (Card)", "GPU 3 (Card)", "GPU 3 (Card)"}));
}

}  // namespace
}  // namespace tsar
