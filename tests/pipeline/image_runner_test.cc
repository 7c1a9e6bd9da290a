// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/image_runner.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <sstream>

#include "tests/pipeline/counting_device.h"
#include "tests/pipeline/drawn_workspace.h"
#include "tests/workspace/test_workspace.h"

namespace tsar {
namespace {

// A GPU whose memory ends, or that is lost, in the middle of its work.
class BrokenDevice : public CountingDevice {
 public:
  BrokenDevice(ErrorCode code, int num_good_allocations)
      : CountingDevice("Card", size_t{1} << 30),
        code_(code),
        num_good_allocations_(num_good_allocations) {}

  void* Allocate(size_t num_bytes) override {
    if (NumAllocations() == num_good_allocations_) {
      is_broken_ = true;
      throw Error(code_, "GPU: it is broken; repair it");
    }
    return CountingDevice::Allocate(num_bytes);
  }
  void Synchronize() override {
    if (is_broken_ && code_ == ErrorCode::kDevice) {
      throw Error(code_, "GPU: lost; find it");
    }
  }

 private:
  const ErrorCode code_;
  const int num_good_allocations_;
  bool is_broken_ = false;
};

class ImageRunnerTest : public testing::Test {
 protected:
  // Runs all images with one worker; what a stage throws is kept.
  void Run(std::unique_ptr<Device> device) {
    DrawWorkspace(root_);
    const Workspace workspace(root_, MapType::kGeometric);
    std::vector<RefineWorker> workers;
    DeviceViewCache views(1 << 20);
    workers.push_back({"GPU 3 (Card)", std::move(device), &views});
    const RefineOptions options;
    ImageRunner runner(workspace, std::vector<bool>(4, true), options, workers);
    ViewCache cache(
        1 << 30, 1 << 20, [&](int image) { return runner.Load(image); });
    std::ostringstream text;
    Progress progress(text, false);
    const std::function<bool()> never = [] { return false; };
    ImagePipeline pipeline(runner, cache, {}, progress, never);
    pipeline.Run(1);
    reports_ = pipeline.Reports();
    failures_ = pipeline.Failures();
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  std::vector<ImageReport> reports_;
  std::vector<std::exception_ptr> failures_;
};

TEST_F(ImageRunnerTest, NamesTheGpuAndTheImageThatItFailedOn) {
  Run(std::make_unique<CountingDevice>("Card", size_t{1} << 30));
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(reports_[i].outcome, ImageReport::Outcome::kRefined);
    EXPECT_FALSE(failures_[i]);
  }
  for (const ErrorCode code : {ErrorCode::kOutOfMemory, ErrorCode::kDevice}) {
    // While the first image is uploaded, and in the middle of the third.
    for (const int num_allocations : {4, 300}) {
      std::filesystem::remove_all(root_);
      Run(std::make_unique<BrokenDevice>(code, num_allocations));
      const auto failed =
          static_cast<size_t>(std::find_if(failures_.begin(),
                                           failures_.end(),
                                           [](const std::exception_ptr& f) {
                                             return f != nullptr;
                                           }) -
                              failures_.begin());
      ASSERT_LT(failed, 4u);
      EXPECT_EQ(failed == 0, num_allocations == 4);
      const std::string& name = DrawnWorkspace::Names()[failed];
      ExpectError(code, {name + " on GPU 3 (Card): GPU: it is broken"}, [&] {
        std::rethrow_exception(failures_[failed]);
      });
      EXPECT_EQ(reports_[failed].outcome, ImageReport::Outcome::kNotDone);
      for (size_t i = 0; i < failed; ++i) {
        EXPECT_EQ(reports_[i].outcome, ImageReport::Outcome::kRefined);
      }
    }
  }
}

}  // namespace
}  // namespace tsar
