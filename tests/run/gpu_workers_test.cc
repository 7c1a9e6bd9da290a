// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/gpu_workers.h"

#include <cstddef>
#include <string>
#include <vector>

#include "tests/run/refine_devices_fixture.h"
#include <gmock/gmock.h>

namespace tsar {
namespace {

using GpuWorkersTest = RefineDevicesTest;

TEST_F(GpuWorkersTest, TakesTheNamedGpusInTheirOrder) {
  options_.gpu_indices = {2, 0};
  EXPECT_EQ(Create(3).description, "GPU 2 (Card), GPU 0 (Card)");
  options_.gpu_indices = {0, 3};
  ExpectRefusal(
      ErrorCode::kDevice, {"gpu_index", "no GPU 3", "has 3", "0 to 2"}, 3);
  options_.gpu_indices = {1};
  ExpectRefusal(ErrorCode::kDevice, {"gpu_index", "no GPU 1", "number 0"}, 1);
}

TEST_F(GpuWorkersTest, LeavesOutGpusWithoutCodeUnlessNamed) {
  without_code_ = {0};
  EXPECT_EQ(Create(2).description, "GPU 1 (Card)");
  options_.gpu_indices = {0, 1};
  ExpectRefusal(ErrorCode::kDevice, {"GPU 0 has no code"}, 2);
}

TEST_F(GpuWorkersTest, UsesOneWorkerWhereTwoDoNotFit) {
  memory_[0] = static_cast<size_t>(DeviceBytes(Plan(), 1)) * 3 / 2;
  EXPECT_EQ(Create(1).workers.size(), 1u);
  EXPECT_EQ(Create(2).workers.size(), 3u);
}

TEST_F(GpuWorkersTest, SaysWhatAnImageNeedsWhereNoneFits) {
  overview_.max_num_pixels = 23000000;
  memory_[0] = kGigabyte;
  const std::vector<std::string> texts = {"GPU 0 (Card)",
                                          "needs 1.2 GB",
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

TEST_F(GpuWorkersTest, LabelsAloneNeedLessThanImages) {
  overview_.max_num_pixels = 23000000;
  memory_[0] = kGigabyte;
  ExpectRefusal(ErrorCode::kDevice, {"GPU 0 (Card)"}, 1);
  const std::vector<GpuWorkers> gpus = OpenForLabels(1);
  ASSERT_EQ(gpus.size(), 1u);
  EXPECT_EQ(gpus[0].devices.size(), 2u);
  // Neither more than there is nor less than the labels need.
  ModelResources model;
  AddGpus(gpus, Plan(), &model);
  EXPECT_LT(model.max_gpu_bytes, static_cast<int64_t>(kGigabyte / 2));
  EXPECT_GE(model.max_gpu_bytes, Plan().label_work);
  // What is too small for that is refused.
  memory_[0] = static_cast<size_t>(Plan().label_work);
  ExpectError(ErrorCode::kDevice, {"GPU 0 (Card)", "of GPU memory"}, [&] {
    OpenForLabels(1);
  });
}

TEST_F(GpuWorkersTest, GoesOnWhereASecondWorkerCannotBeMade) {
  max_num_devices_ = 1;
  for (const std::vector<int>& gpu_indices :
       {std::vector<int>(), std::vector<int>({0, 1})}) {
    options_.gpu_indices = gpu_indices;
    testing::internal::CaptureStderr();
    const RefineDevices devices = Create(2);
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                testing::HasSubstr("GPU 1 (Card) works on 1 image at a time"));
    EXPECT_EQ(Names(devices),
              std::vector<std::string>({"GPU 0 (Card)", "GPU 1 (Card)"}));
    EXPECT_EQ(devices.sizes.max_ready, 2u);
  }
  // Without the first there is none.
  max_num_devices_ = 0;
  ExpectRefusal(ErrorCode::kOutOfMemory, {"could not be pinned"}, 2);
}

}  // namespace
}  // namespace tsar
