// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/main_memory_division.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>

#include "tests/run/refine_devices_fixture.h"
#include <gmock/gmock.h>

namespace tsar {
namespace {

class MainMemoryDivisionTest : public RefineDevicesTest {
 protected:
  // Main memory for all but the views.
  int64_t BytesBeside(const RefineDevices& devices) const {
    const MemoryPlan plan = Plan();
    const auto num_workers = static_cast<int>(devices.workers.size());
    const auto num_loaders = int64_t{devices.sizes.num_loaders};
    const bool on_cpu = options_.choice == DeviceChoice::kCpu;
    EXPECT_EQ(devices.finds_scenes_ahead, !on_cpu);
    // One with each worker, those that wait, and those being written.
    const int64_t num_results =
        num_workers + static_cast<int64_t>(devices.sizes.max_finished) +
        devices.sizes.num_writers;
    // Of images at work and, where scenes are found ahead, of those before.
    const size_t num_scenes =
        devices.workers.size() +
        (on_cpu ? 0
                : static_cast<size_t>(num_loaders) + devices.sizes.max_ready);
    const int64_t uploaded =
        plan.uploaded_view * std::max(num_workers * plan.num_sources,
                                      plan.num_sources + num_workers);
    return num_results * plan.result +
           std::max(devices.sizes.num_writers * plan.make_evidence,
                    EvidenceBytes(plan, num_scenes)) +
           num_loaders * plan.load +
           (on_cpu ? num_workers * plan.work + uploaded : 0);
  }
};

TEST_F(MainMemoryDivisionTest, WarnsWhereOneImageNeedsMoreThanTheCacheSize) {
  for (const DeviceChoice device : {DeviceChoice::kCpu, DeviceChoice::kCuda}) {
    SCOPED_TRACE(ToString(device));
    options_.choice = device;
    options_.cache_size = 0.25;
    testing::internal::CaptureStderr();
    const RefineDevices devices = Create(1);
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_THAT(text, testing::HasSubstr("with its 10 source images"));
    EXPECT_THAT(text, testing::HasSubstr("cache_size 0.25;"));
    const double needed =
        static_cast<double>(BytesBeside(devices) + 11 * Plan().view) / 1e9;
    std::ostringstream number;
    number << "needs " << std::ceil(needed * 10) / 10 << " GB of main memory";
    EXPECT_THAT(text, testing::HasSubstr(number.str()));

    options_.cache_size = needed + 1e-3;
    testing::internal::CaptureStderr();
    EXPECT_GE(static_cast<int64_t>(Create(1).cache_num_bytes),
              11 * Plan().view);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  }
}

TEST_F(MainMemoryDivisionTest, TakesFewerCpuWorkersBeforeItNeedsMore) {
  options_.choice = DeviceChoice::kCpu;
  for (const int num_sources : {1, 10}) {
    overview_.max_num_sources = num_sources;
    for (double cache_size = 0.42 + 0.042 * num_sources; cache_size < 3.0;
         cache_size += 0.02) {
      options_.cache_size = cache_size;
      const RefineDevices devices = Create(0);
      EXPECT_GE(static_cast<int64_t>(devices.cache_num_bytes),
                (num_sources + 1) * Plan().view)
          << cache_size;
    }
    EXPECT_GT(Create(0).workers.size(), 3u);
  }
}

TEST_F(MainMemoryDivisionTest, TakesFewerLoadersWhereTheCacheIsSmall) {
  // The decoded images are much larger than the maps.
  overview_.max_num_image_pixels = 100000000;
  options_.cache_size = 32;
  EXPECT_EQ(Create(1).sizes.num_loaders, 20);
  EXPECT_EQ(Create(1).sizes.num_writers, 16);
  options_.cache_size = 1.8;
  const RefineDevices devices = Create(1);
  EXPECT_EQ(devices.sizes.num_loaders, 2);
  EXPECT_GE(static_cast<int64_t>(devices.cache_num_bytes), 11 * Plan().view);
}

TEST_F(MainMemoryDivisionTest, LeavesAFifthOfTheMachinesMemory) {
  for (const DeviceChoice device : {DeviceChoice::kCpu, DeviceChoice::kCuda}) {
    options_.choice = device;
    options_.cache_size = 32;
    machine_bytes_ = 10 * static_cast<int64_t>(kGigabyte);
    const size_t num_bytes = Create(1).cache_num_bytes;
    options_.cache_size = 8;
    EXPECT_EQ(num_bytes, Create(1).cache_num_bytes);
    machine_bytes_ = INT64_MAX;
    EXPECT_EQ(num_bytes, Create(1).cache_num_bytes);
    options_.cache_size = 7;
    EXPECT_LT(Create(1).cache_num_bytes, num_bytes);
  }
}

TEST_F(MainMemoryDivisionTest, AllMemoryTogetherIsTheCacheSize) {
  for (const DeviceChoice device : {DeviceChoice::kCpu, DeviceChoice::kCuda}) {
    options_.choice = device;
    for (const double cache_size : {0.001, 1.0, 8.0}) {
      options_.cache_size = cache_size;
      const RefineDevices devices = Create(2);
      EXPECT_EQ(devices.finds_scenes_ahead,
                options_.choice == DeviceChoice::kCuda);
      EXPECT_LE(static_cast<int64_t>(devices.cache_num_bytes),
                std::max<int64_t>(0,
                                  static_cast<int64_t>(cache_size * 1e9) -
                                      BytesBeside(devices)));
      EXPECT_EQ(devices.cache_num_bytes == 0, cache_size == 0.001);
    }
  }
}

class VeryLargeMapsTest : public RefineDevicesTest {
 protected:
  VeryLargeMapsTest() {
    // 150 megapixels.
    overview_.max_num_pixels = int64_t{14142} * 10607;
    overview_.max_num_image_pixels = overview_.max_num_pixels;
    overview_.max_num_sources = 2;
    options_.choice = DeviceChoice::kCpu;
  }
  std::string WarningOf(int num_images) {
    testing::internal::CaptureStderr();
    Create(0, num_images);
    return testing::internal::GetCapturedStderr();
  }
};

TEST_F(VeryLargeMapsTest, FitOnALargeMachineWithoutAWarning) {
  EXPECT_EQ(WarningOf(100), "");
  EXPECT_EQ(Create(0).workers.size(), 1u);
  EXPECT_GE(static_cast<int64_t>(Create(0).cache_num_bytes), 3 * Plan().view);
}

TEST_F(VeryLargeMapsTest, AreRefusedWithWhatTheyNeedAndWhatWouldFit) {
  machine_bytes_ = 12 * static_cast<int64_t>(kGigabyte);
  ExpectRefusal(ErrorCode::kOutOfMemory,
                {"with its 2 source images",
                 "needs 23.1 GB of main memory",
                 "this machine gives 12 GB;",
                 "fewer source images",
                 "--PatchMatchStereo.max_image_size",
                 "(maps of 76 megapixels fit)"},
                0);
  // What the message says is so, and not much more would do.
  overview_.max_num_pixels = 76000000;
  EXPECT_THAT(WarningOf(100), testing::HasSubstr("four fifths of the 12 GB"));
  overview_.max_num_pixels = 77000000;
  ExpectRefusal(ErrorCode::kOutOfMemory, {"this machine gives 12 GB"}, 0);
}

TEST_F(VeryLargeMapsTest, NeedLessForOneImageAlone) {
  machine_bytes_ = 16 * static_cast<int64_t>(kGigabyte);
  ExpectRefusal(ErrorCode::kOutOfMemory, {"this machine gives 16 GB"}, 0);
  EXPECT_THAT(
      WarningOf(1),
      testing::HasSubstr(
          "more than four fifths of the 16 GB that this machine gives"));
}

TEST_F(VeryLargeMapsTest, AreRefusedOnASmallGpuToo) {
  options_.choice = DeviceChoice::kCuda;
  memory_[0] = 4 * kGigabyte;
  ExpectRefusal(
      ErrorCode::kDevice,
      {"needs 6.6 GB of GPU memory", "4.0 GB are free", "max_image_size"},
      1);
  memory_[0] = 40 * kGigabyte;
  EXPECT_EQ(Create(1).workers.size(), 2u);
}

}  // namespace
}  // namespace tsar
