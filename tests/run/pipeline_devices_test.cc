// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/pipeline_devices.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tests/run/counting_device.h"
#include "tests/support/test_workspace.h"
#include <gmock/gmock.h>

namespace tsar {
namespace {

constexpr size_t kGigabyte = 1000000000;

// Refinement of images of one megapixel with ten sources each, on a machine
// with these GPUs.
class PipelineDevicesTest : public testing::Test {
 protected:
  PipelineDevicesTest() {
    overview_.max_num_pixels = 1000000;
    overview_.max_num_sources = 10;
    options_.num_threads = 16;
  }

  GpuSystem Gpus(int num_gpus) {
    return {
        [this, num_gpus] {
          EXPECT_NE(options_.choice, DeviceChoice::kCpu)
              << "the driver is not needed";
          return num_gpus;
        },
        [this](int index) {
          if (without_code_.count(index) > 0 || index < 0) {
            throw Error(
                ErrorCode::kDevice,
                "GPU " + std::to_string(index) + " has no code; build it");
          }
          ++num_created_[index];
          if (num_created_[index] > max_num_devices_) {
            throw Error(ErrorCode::kOutOfMemory,
                        "main memory could not be pinned; close others");
          }
          const size_t memory =
              memory_.count(index) > 0 ? memory_[index] : 8 * kGigabyte;
          return std::unique_ptr<Device>(new CountingDevice("Card", memory));
        }};
  }
  PipelineDevices Create(int num_gpus, int num_images = 100) {
    num_created_.clear();
    return OpenPipelineDevices(
        options_, Plan(), num_images, Gpus(num_gpus), machine_bytes_);
  }
  void ExpectRefusal(ErrorCode code,
                     const std::vector<std::string>& texts,
                     int num_gpus) {
    ExpectError(code, texts, [&] { Create(num_gpus); });
  }

  MemoryPlan Plan() const { return PlanRefinement({}, overview_); }

  WorkspaceOverview overview_;
  DeviceOptions options_;
  std::map<int, size_t> memory_;
  std::set<int> without_code_;
  std::map<int, int> num_created_;
  int max_num_devices_ = kMaxGpuWorkers;  // For each GPU.
  int64_t machine_bytes_ = 64 * static_cast<int64_t>(kGigabyte);
};

// The names of all workers.
std::vector<std::string> Names(const PipelineDevices& devices) {
  std::vector<std::string> names;
  for (const PipelineWorker& worker : devices.workers) {
    names.push_back(worker.name);
  }
  return names;
}

TEST_F(PipelineDevicesTest, TakesEveryGpuWithSeveralWorkers) {
  const PipelineDevices devices = Create(2);
  const std::vector<PipelineWorker>& workers = devices.workers;
  std::vector<std::string> names(kMaxGpuWorkers, "GPU 0 (Card)");
  names.resize(2 * kMaxGpuWorkers, "GPU 1 (Card)");
  ASSERT_EQ(Names(devices), names);
  EXPECT_EQ(workers[0].views, workers[kMaxGpuWorkers - 1].views);
  EXPECT_NE(workers[kMaxGpuWorkers - 1].views, workers[kMaxGpuWorkers].views);
  EXPECT_NE(workers[0].device, workers[1].device);
  EXPECT_EQ(devices.description, "GPU 0 (Card), GPU 1 (Card)");
  EXPECT_EQ(devices.at_work.num_workers, 2 * kMaxGpuWorkers);
  EXPECT_GT(devices.at_work.num_threads, options_.num_threads);
}

TEST_F(PipelineDevicesTest, WithoutAnyGpuAutoMeansTheCpu) {
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

TEST_F(PipelineDevicesTest, TheModelPassHasTheGpusOfTheWorkers) {
  const PipelineDevices devices = Create(2);
  ASSERT_EQ(devices.model.gpus.size(), devices.workers.size());
  for (size_t i = 0; i < devices.workers.size(); ++i) {
    EXPECT_EQ(devices.model.gpus[i].name, devices.workers[i].name);
    EXPECT_EQ(devices.model.gpus[i].device, devices.workers[i].device.get());
  }
  options_.choice = DeviceChoice::kCpu;
  EXPECT_TRUE(Create(2).model.gpus.empty());
}

TEST_F(PipelineDevicesTest, WhatTheModelPassKeepsIsWhatIsLeftOfMainMemory) {
  options_.choice = DeviceChoice::kCpu;
  const ModelResources model = Create(0).model;
  EXPECT_EQ(model.num_views, 16);
  EXPECT_EQ(model.max_kept_bytes + 16 * Plan().label_view,
            static_cast<int64_t>(options_.cache_size * kGigabyte));
  // Views are labeled one at a time, and no memory is left.
  options_.cache_size = 0.001;
  EXPECT_EQ(Create(0).model.num_views, 1);
  EXPECT_EQ(Create(0).model.max_kept_bytes, 0);
}

TEST_F(PipelineDevicesTest, NoMoreWorkersThanImages) {
  for (int num_gpus = 1; num_gpus <= 4; ++num_gpus) {
    for (int num_images = 1; num_images <= 10; ++num_images) {
      const PipelineDevices devices = Create(num_gpus, num_images);
      EXPECT_EQ(static_cast<int>(devices.workers.size()),
                std::min(num_images, kMaxGpuWorkers * num_gpus));
      // No GPU is opened that gets no image.
      EXPECT_EQ(static_cast<int>(num_created_.size()),
                std::min(num_images, num_gpus));
      EXPECT_EQ(devices.view_caches.size(), num_created_.size());
    }
  }
  options_.choice = DeviceChoice::kCpu;
  EXPECT_EQ(Create(1, 3).workers.size(), 3u);
}

TEST_F(PipelineDevicesTest, EveryGpuGetsAnImageBeforeOneGetsTwo) {
  EXPECT_EQ(Names(Create(2, 2)),
            std::vector<std::string>({"GPU 0 (Card)", "GPU 1 (Card)"}));
  EXPECT_EQ(Names(Create(2, 3)),
            std::vector<std::string>(
                {"GPU 0 (Card)", "GPU 0 (Card)", "GPU 1 (Card)"}));
  // The next one replaces one that cannot be used.
  without_code_ = {0};
  memory_[1] = 1;
  EXPECT_EQ(Names(Create(4, 1)), std::vector<std::string>({"GPU 2 (Card)"}));
  memory_[2] = static_cast<size_t>(Plan().device) * 3 / 2;
  EXPECT_EQ(Names(Create(4, 3)),
            std::vector<std::string>(
                {"GPU 2 (Card)", "GPU 3 (Card)", "GPU 3 (Card)"}));
}

TEST_F(PipelineDevicesTest, TakesTheNamedGpusInTheirOrder) {
  options_.gpu_indices = {2, 0};
  EXPECT_EQ(Create(3).description, "GPU 2 (Card), GPU 0 (Card)");
  options_.gpu_indices = {0, 3};
  ExpectRefusal(
      ErrorCode::kDevice, {"gpu_index", "no GPU 3", "has 3", "0 to 2"}, 3);
  options_.gpu_indices = {1};
  ExpectRefusal(ErrorCode::kDevice, {"gpu_index", "no GPU 1", "number 0"}, 1);
}

TEST_F(PipelineDevicesTest, LeavesOutGpusWithoutCodeUnlessNamed) {
  without_code_ = {0};
  EXPECT_EQ(Create(2).description, "GPU 1 (Card)");
  options_.gpu_indices = {0, 1};
  ExpectRefusal(ErrorCode::kDevice, {"GPU 0 has no code"}, 2);
}

TEST_F(PipelineDevicesTest, SaysWhatAnImageNeedsWhereNoneFits) {
  overview_.max_num_pixels = 23000000;
  memory_[0] = kGigabyte;
  const std::vector<std::string> texts = {"GPU 0 (Card)",
                                          "needs 1.3 GB",
                                          "1.0 GB are free",
                                          "close other programs",
                                          "gpu_index",
                                          "max_image_size",
                                          "device cpu"};
  ExpectRefusal(ErrorCode::kDevice, texts, 1);
  // Another has enough.
  EXPECT_EQ(Create(2).description, "GPU 1 (Card)");
  options_.gpu_indices = {0, 1};
  ExpectRefusal(ErrorCode::kDevice, texts, 2);
}

TEST_F(PipelineDevicesTest, GivesGpusAsManyWorkersAsFit) {
  size_t most = 0;
  for (size_t tenths = 20; tenths <= 20 * kMaxGpuWorkers; ++tenths) {
    memory_[0] = static_cast<size_t>(Plan().device) * tenths / 10;
    const size_t num_workers = Create(1).workers.size();
    EXPECT_GE(num_workers, most);
    EXPECT_LE(10 * num_workers, tenths);
    most = num_workers;
  }
  EXPECT_EQ(most, static_cast<size_t>(kMaxGpuWorkers));
}

TEST_F(PipelineDevicesTest, GoesOnWhereASecondWorkerCannotBeMade) {
  max_num_devices_ = 1;
  for (const std::vector<int>& gpu_indices :
       {std::vector<int>(), std::vector<int>({0, 1})}) {
    options_.gpu_indices = gpu_indices;
    testing::internal::CaptureStderr();
    const PipelineDevices devices = Create(2);
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                testing::HasSubstr("GPU 1 (Card) works on 1 image at a time"));
    EXPECT_EQ(Names(devices),
              std::vector<std::string>({"GPU 0 (Card)", "GPU 1 (Card)"}));
  }
  max_num_devices_ = 2;
  testing::internal::CaptureStderr();
  EXPECT_EQ(Create(2).workers.size(), 4u);
  EXPECT_EQ(num_created_[0], 3);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("works on 2 images at a time"));
  // Without the first there is none.
  max_num_devices_ = 0;
  ExpectRefusal(ErrorCode::kOutOfMemory, {"could not be pinned"}, 2);
}

}  // namespace
}  // namespace tsar
