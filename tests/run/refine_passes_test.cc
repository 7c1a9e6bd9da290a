// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_passes.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/run/model_pass.h"
#include "colmap_tsar/view/reduce_view.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

#include "tests/run/counting_device.h"
#include "tests/support/synthetic_workspace.h"
#include "tests/support/test_workspace.h"
#include <gmock/gmock.h>

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

class RefinePassesTest : public testing::Test {
 protected:
  // Runs all images with one worker; exceptions are kept. With scene_planes,
  // the images are observed first; if that fails, nothing else runs.
  void Run(std::unique_ptr<CountingDevice> device,
           bool scene_planes,
           bool finds_scenes_ahead = false) {
    const CountingDevice& counter = *device;
    const Workspace workspace(root_, MapType::kGeometric);
    PipelineDevices devices;
    devices.view_caches.push_back(std::make_unique<UploadedViews>(4));
    devices.workers.push_back(
        {"GPU 3 (Card)", std::move(device), devices.view_caches.front().get()});
    devices.finds_scenes_ahead = finds_scenes_ahead;
    WorkspaceOverview overview;
    RefineOptions options;
    options.scene_planes = scene_planes;
    const InputFingerprints inputs(workspace);
    EvidenceStore evidence(workspace, HashRefineOptions(options), 4);
    const std::vector<bool> all(4, true);
    const ImageSelection selection(
        workspace, inputs, all, all, CurrentRecord(workspace, options, inputs));
    const WorkspaceRefineOptions workspace_options;
    const std::vector<size_t> images = {0, 1, 2, 3};
    std::ostringstream text;
    Progress progress(text, false);
    const RefineRun run = {workspace_options,
                           options,
                           progress,
                           workspace,
                           overview,
                           images,
                           devices,
                           inputs,
                           selection,
                           evidence};
    std::vector<StageSeconds> seconds(4);
    if (scene_planes) {
      ObservePass observe(run, seconds);
      RunPipeline(observe, run);
      observed_ = reports_;
      num_allocations_to_observe_ = counter.NumAllocations();
      if (FirstFailed() < 4) {
        return;
      }
      EXPECT_TRUE(run.HasCurrentPlanes() || ModelWorkspace(run));
    }
    ComposePass compose(run, seconds);
    RunPipeline(compose, run);
    num_allocations_ = counter.NumAllocations();
  }
  void RunPipeline(ImagePass<RefineResult>& pass, const RefineRun& run) {
    PipelineOutcome outcome = ImagePipeline<RefineResult>(pass,
                                                          run.images,
                                                          "",
                                                          {},
                                                          /*max_num_views=*/8,
                                                          run.progress)
                                  .Run();
    reports_ = std::move(outcome.reports);
    failures_ = std::move(outcome.failures);
  }
  void Run(bool scene_planes, bool finds_scenes_ahead = false) {
    Run(std::make_unique<CountingDevice>("Card", size_t{1} << 30),
        scene_planes,
        finds_scenes_ahead);
  }
  // Runs on a new workspace and a device that breaks.
  void RunBroken(ErrorCode code, int num_allocations, bool scene_planes) {
    std::filesystem::remove_all(root_);
    MakeSyntheticWorkspace(root_);
    Run(std::make_unique<BrokenDevice>(code, num_allocations), scene_planes);
  }

  size_t FirstFailed() const {
    return static_cast<size_t>(
        std::find_if(failures_.begin(),
                     failures_.end(),
                     [](const std::exception_ptr& f) { return f != nullptr; }) -
        failures_.begin());
  }
  // Expects that the failure names its image, which is unchanged, and that
  // those before it are refined.
  void ExpectFailure(ErrorCode code) const {
    const size_t failed = FirstFailed();
    ASSERT_LT(failed, 4u);
    const std::string& name = SyntheticWorkspace::Names()[failed];
    ExpectError(code, {name + " on GPU 3 (Card): GPU: it is broken"}, [&] {
      std::rethrow_exception(failures_[failed]);
    });
    EXPECT_EQ(reports_[failed].outcome, ImageReport::Outcome::kNotDone);
    for (size_t i = 0; i < failed; ++i) {
      EXPECT_EQ(reports_[i].outcome, ImageReport::Outcome::kDone);
    }
  }
  void ExpectAllRefined() const {
    for (size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(reports_[i].outcome, ImageReport::Outcome::kDone);
      EXPECT_FALSE(failures_[i]);
    }
  }
  // All files but this program's own.
  std::map<std::string, std::string> ReadMaps() const {
    std::map<std::string, std::string> files = ReadTree(root_);
    std::erase_if(files, [](const auto& file) {
      return file.first.starts_with("stereo/tsar");
    });
    return files;
  }

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  std::vector<ImageReport> reports_;
  std::vector<ImageReport> observed_;
  std::vector<std::exception_ptr> failures_;
  // By image.
  int num_allocations_to_observe_ = 0;
  int num_allocations_ = 0;
};

TEST_F(RefinePassesTest, NamesTheGpuAndTheImageThatItFailedOn) {
  MakeSyntheticWorkspace(root_);
  Run(false);
  ExpectAllRefined();
  for (const ErrorCode code : {ErrorCode::kOutOfMemory, ErrorCode::kDevice}) {
    // While the first image is uploaded, and in the middle of the third.
    for (const int num_allocations : {4, 300}) {
      RunBroken(code, num_allocations, false);
      ExpectFailure(code);
      EXPECT_EQ(FirstFailed() == 0, num_allocations == 4);
    }
  }
}

TEST_F(RefinePassesTest, AFailureWhileObservingChangesNoMap) {
  MakeSyntheticWorkspace(root_);
  const auto before = ReadMaps();
  Run(true);
  ExpectAllRefined();
  EXPECT_FALSE(ReadMaps() == before);
  for (const int num_allocations : {4, num_allocations_to_observe_ - 1}) {
    RunBroken(ErrorCode::kOutOfMemory, num_allocations, true);
    ExpectFailure(ErrorCode::kOutOfMemory);
    EXPECT_EQ(FirstFailed(), num_allocations == 4 ? 0u : 3u);
    EXPECT_TRUE(ReadMaps() == before);
  }
}

TEST_F(RefinePassesTest, AFailureWhileComposingLeavesTheOthersRefined) {
  MakeSyntheticWorkspace(root_);
  Run(true);
  const auto refined = ReadMaps();
  const int num_observing = num_allocations_to_observe_;
  const int num_all = num_allocations_;
  for (const ErrorCode code : {ErrorCode::kOutOfMemory, ErrorCode::kDevice}) {
    for (const int num_allocations : {num_observing, num_all - 1}) {
      RunBroken(code, num_allocations, true);
      ExpectFailure(code);
      EXPECT_EQ(FirstFailed(), num_allocations == num_observing ? 0u : 3u);
      // Observations stay valid, even of images whose maps changed.
      Run(true);
      for (const ImageReport& report : observed_) {
        EXPECT_EQ(report.outcome, ImageReport::Outcome::kSkipped);
      }
      EXPECT_TRUE(ReadMaps() == refined);
    }
  }
}

TEST_F(RefinePassesTest, WhoFindsTheScenesChangesNoByte) {
  MakeSyntheticWorkspace(root_);
  Run(true);
  ExpectAllRefined();
  const std::map<std::string, std::string> maps = ReadMaps();
  std::filesystem::remove_all(root_);
  MakeSyntheticWorkspace(root_);
  Run(true, true);
  ExpectAllRefined();
  EXPECT_TRUE(ReadMaps() == maps);
  for (const ImageReport& report : reports_) {
    EXPECT_GT(report.seconds.count("labels"), 0u);
  }
}

TEST_F(RefinePassesTest, ObservesOnlyWhatSomebodyNeeds) {
  MakeSyntheticWorkspace(root_);
  WriteText(root_ / "stereo/patch-match.cfg",
            "v0.png\nv1.png\nv1.png\nv0.png\n"
            "left/v2.png\nv3.png\nv3.png\nleft/v2.png\n");
  Run(true);
  ExpectAllRefined();
  // One image is to be refined again, for which two views are needed.
  const Workspace workspace(root_, MapType::kGeometric);
  EvidenceStore::Clear(workspace);
  std::filesystem::remove(workspace.Paths(1, MapType::kGeometric).confidence);
  Run(true);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(observed_[i].outcome == ImageReport::Outcome::kDone, i < 2) << i;
    EXPECT_EQ(reports_[i].outcome == ImageReport::Outcome::kDone, i == 1) << i;
  }
  // The times of both passes are recorded, for this image only.
  EXPECT_GT(reports_[1].seconds.at("superpixels"), 0.0);
  EXPECT_GT(reports_[1].seconds.at("labels"), 0.0);
}

}  // namespace
}  // namespace tsar
