// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/refine_devices.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/controllers/memory_plan.h"
#include "colmap_tsar/pipeline/refine_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/controllers/counting_device.h"
#include "tests/support/drawn_views.h"
#include "tests/support/observe_image.h"
#include "tests/support/test_workspace.h"
#include <gmock/gmock.h>

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
    return {
        [this, num_gpus] {
          EXPECT_NE(options_.device, "cpu") << "the driver is not needed";
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
  RefineDevices Create(int num_gpus, int num_images = 100) {
    num_created_.clear();
    return CreateRefineDevices(
        options_, overview_, num_images, Gpus(num_gpus), machine_bytes_);
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
  std::map<int, int> num_created_;
  int max_num_devices_ = kMaxGpuWorkers;  // Of each GPU.
  int64_t machine_bytes_ = 64 * static_cast<int64_t>(kGigabyte);
};

// The names of all workers.
std::vector<std::string> Names(const RefineDevices& devices) {
  std::vector<std::string> names;
  for (const RefineWorker& worker : devices.workers) {
    names.push_back(worker.name);
  }
  return names;
}

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
  options_.device = "cpu";
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
  memory_[2] = static_cast<size_t>(WorkBytes(overview_)) * 3 / 2;
  EXPECT_EQ(Names(Create(4, 3)),
            std::vector<std::string>(
                {"GPU 2 (Card)", "GPU 3 (Card)", "GPU 3 (Card)"}));
}

TEST_F(RefineDevicesTest, GoesOnWhereASecondWorkerCannotBeMade) {
  max_num_devices_ = 1;
  for (const char* gpu_index : {"-1", "0,1"}) {
    options_.gpu_index = gpu_index;
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

TEST_F(RefineDevicesTest, WarnsWhereOneImageNeedsMoreThanTheCacheSize) {
  for (const char* device : {"cpu", "cuda"}) {
    SCOPED_TRACE(device);
    options_.device = device;
    options_.cache_size = 0.25;
    testing::internal::CaptureStderr();
    const RefineDevices devices = Create(1);
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_THAT(text, testing::HasSubstr("with its 10 source images"));
    EXPECT_THAT(text, testing::HasSubstr("cache_size 0.25;"));
    // One loader; a result with each worker, one that waits, one that is being
    // written; 11 views; and the evidence of 11 for each worker and for one to
    // come.
    const double needed =
        static_cast<double>(
            LoadBytes(overview_) +
            static_cast<int64_t>(devices.workers.size() + 2) *
                ResultBytes(overview_) +
            11 * ViewBytes(overview_) +
            EvidenceBytes(
                overview_,
                devices.workers.size() +
                    (devices.finds_scenes_ahead
                         ? static_cast<size_t>(devices.sizes.num_loaders) +
                               devices.sizes.max_ready
                         : 0)) +
            (devices.finds_scenes_ahead
                 ? devices.sizes.num_loaders
                 : static_cast<int64_t>(devices.workers.size())) *
                DiscoveryBytes(overview_) +
            (options_.device == "cpu" ? WorkBytes(overview_) : 0)) /
        1e9;
    std::ostringstream number;
    number << "needs " << std::ceil(needed * 10) / 10 << " GB of main memory";
    EXPECT_THAT(text, testing::HasSubstr(number.str()));

    options_.cache_size = needed + 1e-3;
    testing::internal::CaptureStderr();
    EXPECT_GE(static_cast<int64_t>(Create(1).cache_num_bytes),
              11 * ViewBytes(overview_));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  }
}

// Memory for two images is not used for three workers.
TEST_F(RefineDevicesTest, TakesFewerCpuWorkersBeforeItNeedsMore) {
  options_.device = "cpu";
  for (const int num_sources : {1, 10}) {
    overview_.max_num_sources = num_sources;
    for (double cache_size = 0.42 + 0.042 * num_sources; cache_size < 3.0;
         cache_size += 0.02) {
      options_.cache_size = cache_size;
      const RefineDevices devices = Create(0);
      EXPECT_GE(static_cast<int64_t>(devices.cache_num_bytes),
                (num_sources + 1) * ViewBytes(overview_))
          << cache_size;
    }
    EXPECT_GT(Create(0).workers.size(), 3u);
  }
}

TEST_F(RefineDevicesTest, TakesFewerLoadersWhereTheCacheIsSmall) {
  // The decoded images are much larger than the maps.
  overview_.max_num_image_pixels = 100000000;
  options_.cache_size = 32;
  EXPECT_EQ(Create(1).sizes.num_loaders, 6);
  options_.cache_size = 1.8;
  const RefineDevices devices = Create(1);
  EXPECT_EQ(devices.sizes.num_loaders, 2);
  EXPECT_GE(static_cast<int64_t>(devices.cache_num_bytes),
            11 * ViewBytes(overview_));
}

// The default cache_size on a small machine.
TEST_F(RefineDevicesTest, LeavesAFifthOfTheMachinesMemory) {
  for (const char* device : {"cpu", "cuda"}) {
    options_.device = device;
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

class VeryLargeMapsTest : public RefineDevicesTest {
 protected:
  VeryLargeMapsTest() {
    // 150 megapixels.
    overview_.max_num_pixels = int64_t{14142} * 10607;
    overview_.max_num_image_pixels = overview_.max_num_pixels;
    overview_.max_num_sources = 2;
    options_.device = "cpu";
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
  EXPECT_GE(static_cast<int64_t>(Create(0).cache_num_bytes),
            3 * ViewBytes(overview_));
}

TEST_F(VeryLargeMapsTest, AreRefusedWithWhatTheyNeedAndWhatWouldFit) {
  machine_bytes_ = 12 * static_cast<int64_t>(kGigabyte);
  ExpectRefusal(ErrorCode::kOutOfMemory,
                {"with its 2 source images",
                 "needs 30.6 GB of main memory",
                 "this machine gives 12 GB;",
                 "fewer source images",
                 "--PatchMatchStereo.max_image_size",
                 "(maps of 57 megapixels fit)"},
                0);
  // What the message says is so, and not much more would do.
  overview_.max_num_pixels = 57000000;
  EXPECT_THAT(WarningOf(100), testing::HasSubstr("four fifths of the 12 GB"));
  overview_.max_num_pixels = 58000000;
  ExpectRefusal(ErrorCode::kOutOfMemory, {"this machine gives 12 GB"}, 0);
}

TEST_F(VeryLargeMapsTest, NeedLessForOneImageAlone) {
  machine_bytes_ = 26 * static_cast<int64_t>(kGigabyte);
  ExpectRefusal(ErrorCode::kOutOfMemory, {"this machine gives 26 GB"}, 0);
  EXPECT_THAT(
      WarningOf(1),
      testing::HasSubstr(
          "more than four fifths of the 26 GB that this machine gives"));
}

TEST_F(VeryLargeMapsTest, NeedMoreWithCostsAndASecondType) {
  const int64_t view = ViewBytes(overview_);
  const int64_t load = LoadBytes(overview_);
  overview_.has_other_type = true;
  EXPECT_EQ(ViewBytes(overview_), view);
  EXPECT_EQ(LoadBytes(overview_), 16 * overview_.max_num_pixels);
  EXPECT_GT(LoadBytes(overview_), load);
  overview_.has_costs = true;
  EXPECT_EQ(ViewBytes(overview_), view + 8 * overview_.max_num_pixels);
  EXPECT_EQ(LoadBytes(overview_), 24 * overview_.max_num_pixels);
}

TEST_F(VeryLargeMapsTest, AreRefusedOnASmallGpuToo) {
  options_.device = "cuda";
  ExpectRefusal(
      ErrorCode::kDevice,
      {"needs 10.3 GB of GPU memory", "8.0 GB are free", "max_image_size"},
      1);
  memory_[0] = 40 * kGigabyte;
  EXPECT_EQ(Create(1).workers.size(), 2u);
}

TEST(EvidenceBytes, AreThoseOfTheNeighbourhoodsAtWork) {
  WorkspaceOverview overview;
  overview.max_num_sources = 10;
  overview.max_num_pixels = 1000000;
  EXPECT_EQ(NumEvidenceViews(overview, 2), 33u);
  const int64_t bytes = EvidenceBytes(overview, 2);
  // Larger maps have the same raster.
  overview.max_num_pixels *= 10;
  EXPECT_EQ(EvidenceBytes(overview, 2), bytes);
  EXPECT_EQ(EvidenceBytes(overview, 5), 2 * bytes);
}

TEST(DiscoveryBytes, DoNotGrowWithoutBound) {
  WorkspaceOverview overview;
  overview.max_num_sources = 10;
  overview.max_num_pixels = 300000;
  const int64_t bytes = DiscoveryBytes(overview);
  overview.max_num_sources = 5;
  EXPECT_LT(DiscoveryBytes(overview), bytes);
  // The scores are bounded, whatever the candidates.
  overview.max_num_sources = 50;
  overview.max_num_pixels = 10000000;
  const auto max_scores =
      static_cast<int64_t>(DiscoverPlanesOptions().max_scores);
  EXPECT_GT(DiscoveryBytes(overview), 4 * max_scores);
  EXPECT_LT(DiscoveryBytes(overview), 4 * max_scores + (int64_t{1} << 28));
}

TEST_F(RefineDevicesTest, AllMemoryTogetherIsTheCacheSize) {
  for (const char* device : {"cpu", "cuda"}) {
    options_.device = device;
    for (const double cache_size : {0.001, 1.0, 8.0}) {
      options_.cache_size = cache_size;
      const RefineDevices devices = Create(2);
      EXPECT_EQ(devices.finds_scenes_ahead, options_.device == "cuda");
      const auto num_results =
          static_cast<int64_t>(devices.workers.size() +
                               devices.sizes.max_finished) +
          devices.sizes.num_writers;
      const auto work = options_.device == "cpu"
                            ? WorkBytes(overview_) *
                                  static_cast<int64_t>(devices.workers.size())
                            : 0;
      const auto fixed = work + num_results * ResultBytes(overview_) +
                         EvidenceBytes(overview_, devices.workers.size()) +
                         devices.sizes.num_loaders * LoadBytes(overview_);
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
    const auto expect_holds = [&](auto function) {
      CountingDevice device("", SIZE_MAX, 2);
      function(device);
      const auto peak = static_cast<int64_t>(device.PeakMemory());
      EXPECT_LE(peak, WorkBytes(overview));
      return peak;
    };
    const int64_t peak = expect_holds([&](Device& device) {
      RefineImage(drawn.views[0], drawn.Sources(), 1, {}, device);
    });
    EXPECT_GE(peak, WorkBytes(overview) / 2);
    expect_holds([&](Device& device) {
      const RefineResult observed = ObserveImage(
          drawn.views[0], UploadViews(drawn.Sources(), device), 1, {}, device);
      const ViewEvidence& evidence = *observed.evidence;
      // As many views as there are, for the size of the tables.
      const std::vector<ObservedView> views(
          drawn.views.size(),
          {&evidence,
           drawn.views[0].camera.Resized(evidence.width, evidence.height)});
      ComposeImage(drawn.views[0], views, {}, device);
    });
  }
}

}  // namespace
}  // namespace tsar
