// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/image_pipeline.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <numeric>
#include <set>
#include <sstream>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

using Outcome = ImageReport::Outcome;

// Adds up the depths of an image and its sources, which are their numbers.
class DrawnPass : public ImagePass<int64_t> {
 public:
  explicit DrawnPass(int num_images) : num_images_(num_images) {}

  ImageReport Begin(size_t index) override {
    ImageReport report;
    if (done_before.contains(index)) {
      report.outcome = Outcome::kSkipped;
    }
    return report;
  }
  std::vector<int> Views(size_t index) const override {
    std::vector<int> views;
    for (int i = 0; i <= num_sources; ++i) {
      views.push_back((static_cast<int>(index) + 3 * i) % num_images_);
    }
    return views;
  }
  std::shared_ptr<const ViewData> Load(int image) const override {
    if (image == unreadable) {
      throw Error(ErrorCode::kCorrupt, "broken; repair it");
    }
    auto view = std::make_unique<ViewData>();
    view->depth = Image<float>(10, 1, static_cast<float>(image));
    max_alive = std::max<int>(max_alive, ++num_alive_);
    return std::shared_ptr<const ViewData>(view.release(),
                                           [this](const ViewData* dropped) {
                                             delete dropped;
                                             --num_alive_;
                                           });
  }
  int64_t Compute(size_t index,
                  size_t worker,
                  LoadedViews* views,
                  ImageReport* report) override {
    before_compute(index);
    CheckFailure(fails_to_compute, index);
    // Each worker has one image at a time.
    EXPECT_FALSE(is_busy_[worker].exchange(true));
    float sum = 0.f;
    for (const int image : Views(index)) {
      sum += views->Get(image).depth(0, 0);
      views->Release(image);
    }
    report->counts["computed"] = 1;
    is_busy_[worker] = false;
    return static_cast<int64_t>(sum);
  }
  bool WritesAfterStop() const override { return writes_after_stop; }
  void Write(size_t index, int64_t result, ImageReport* report) override {
    CheckFailure(fails_to_write, index);
    report->counts["sum"] = result;
    report->outcome = Outcome::kDone;
    ++num_written;
  }

  int64_t ExpectedSum(size_t index) const {
    const std::vector<int> views = Views(index);
    return std::accumulate(views.begin(), views.end(), int64_t{0});
  }

  int num_sources = 5;
  std::set<size_t> done_before;
  int unreadable = -1;
  std::set<size_t> fails_to_compute;
  std::set<size_t> fails_to_write;
  std::function<void(size_t)> before_compute = [](size_t) {};
  bool writes_after_stop = false;
  std::atomic<int> num_written = 0;
  mutable std::atomic<int> max_alive = 0;  // Views, with one thread.

 private:
  static void CheckFailure(const std::set<size_t>& failing, size_t index) {
    if (failing.contains(index)) {
      throw Error(ErrorCode::kIo, std::to_string(index) + ": fails; repair it");
    }
  }

  const int num_images_;
  mutable std::atomic<int> num_alive_ = 0;
  std::array<std::atomic<bool>, 8> is_busy_ = {};
};

struct PipelineRun {
  explicit PipelineRun(int num_images) : pass(num_images) {
    images.resize(static_cast<size_t>(num_images));
    std::iota(images.begin(), images.end(), size_t{0});
  }

  void Go(int num_threads = 1, int num_workers = 1, size_t max_views = 20) {
    ImagesAtWork at_work;
    at_work.num_threads = num_threads;
    at_work.num_workers = num_workers;
    std::ostringstream text;
    Progress progress(text, false);
    progress.SetStop(should_stop);
    outcome =
        ImagePipeline<int64_t>(pass, images, "", at_work, max_views, progress)
            .Run();
  }

  int NumFailures() const {
    return static_cast<int>(std::ranges::count_if(
        outcome.failures,
        [](const auto& failure) { return failure != nullptr; }));
  }
  int NumWith(Outcome wanted) const {
    return static_cast<int>(
        std::ranges::count(outcome.reports, wanted, &ImageReport::outcome));
  }

  DrawnPass pass;
  std::vector<size_t> images;
  std::function<bool()> should_stop;
  PipelineOutcome outcome;
};

TEST(ImagePipeline, ViewsThatNoImageNeedsAnyMoreAreNotKept) {
  PipelineRun run(60);
  run.pass.num_sources = 1;
  run.pass.done_before = {5, 6};  // These need none.
  run.Go(1, 1, /*max_views=*/1000);
  EXPECT_EQ(run.pass.num_written, 58);
  // Up to five that are next to each other, and three for the last images.
  EXPECT_LE(run.pass.max_alive, 8);
}

TEST(ImagePipeline, TheNumbersOfThreadsAndOfViewsChangeNothing) {
  constexpr int kNumImages = 60;
  for (const int num_threads : {1, 2, 5}) {
    for (const size_t max_views : {0, 6, 1000}) {
      SCOPED_TRACE(std::to_string(num_threads) + " threads, " +
                   std::to_string(max_views) + " views");
      PipelineRun run(kNumImages);
      run.pass.done_before = {0, 17, 59};
      run.Go(num_threads, (num_threads + 1) / 2, max_views);
      EXPECT_EQ(run.NumFailures(), 0);
      EXPECT_EQ(run.NumWith(Outcome::kSkipped), 3);
      EXPECT_EQ(run.NumWith(Outcome::kDone), kNumImages - 3);
      for (size_t i = 0; i < kNumImages; ++i) {
        if (!run.pass.done_before.contains(i)) {
          const ImageReport& report = run.outcome.reports[i];
          EXPECT_EQ(report.counts.at("sum"), run.pass.ExpectedSum(i));
          EXPECT_EQ(report.counts.at("computed"), 1);
          EXPECT_EQ(report.seconds.count("read"), 1u);
        }
      }
    }
  }
}

TEST(ImagePipeline, AFailureEndsTheRunOnceThoseBegunAreDone) {
  constexpr size_t kFailing = 7;
  for (const int num_threads : {1, 3}) {
    for (const char* what : {"read", "compute", "write"}) {
      SCOPED_TRACE(what);
      PipelineRun run(500);
      if (what == std::string("read")) {
        run.pass.unreadable =
            static_cast<int>(kFailing) + 3 * run.pass.num_sources;
      } else {
        (what == std::string("write") ? run.pass.fails_to_write
                                      : run.pass.fails_to_compute) = {kFailing};
      }
      run.Go(num_threads, 2);
      ASSERT_TRUE(run.outcome.failures[kFailing]);
      EXPECT_EQ(run.outcome.reports[kFailing].outcome, Outcome::kNotDone);
      EXPECT_EQ(run.NumWith(Outcome::kDone), run.pass.num_written);
      for (size_t i = 0; i < kFailing; ++i) {
        EXPECT_EQ(run.outcome.reports[i].outcome, Outcome::kDone) << i;
      }
      if (num_threads == 1) {
        EXPECT_EQ(run.NumFailures(), 1);
        EXPECT_EQ(run.outcome.first_failure, run.outcome.failures[kFailing]);
        EXPECT_EQ(run.pass.num_written, static_cast<int>(kFailing));
      }
    }
  }
}

TEST(ImagePipeline, StopsInTheMiddle) {
  for (const int num_threads : {1, 3}) {
    PipelineRun run(300);
    run.should_stop = [&] { return run.pass.num_written >= 20; };
    run.Go(num_threads, num_threads);
    EXPECT_EQ(run.NumFailures(), 0);
    EXPECT_GE(run.pass.num_written, 20);
    // Those that had asked before the twentieth was done.
    EXPECT_LE(run.pass.num_written, 20 + num_threads - 1);
    EXPECT_EQ(run.NumWith(Outcome::kDone), run.pass.num_written);
  }
}

TEST(ImagePipeline, WritesWhatIsWithAWorkerIfTheTasksSaySo) {
  PipelineRun run(300);
  run.pass.writes_after_stop = true;
  std::atomic<bool> is_stopped = false;
  run.pass.before_compute = [&](size_t index) { is_stopped = index == 20; };
  run.should_stop = [&] { return is_stopped.load(); };
  run.Go();
  EXPECT_EQ(run.pass.num_written, 21);
  EXPECT_EQ(run.NumWith(Outcome::kDone), 21);
}

TEST(ImagePipeline, TakesTheImagesThatItIsGiven) {
  PipelineRun run(30);
  run.images = {3, 11, 12, 28};
  run.pass.fails_to_write = {12};
  run.Go();
  ASSERT_EQ(run.outcome.reports.size(), 4u);
  for (const size_t place : {0, 1}) {
    EXPECT_EQ(run.outcome.reports[place].counts.at("sum"),
              run.pass.ExpectedSum(run.images[place]));
  }
  EXPECT_TRUE(run.outcome.failures[2]);
  run.images = {};
  run.Go();
  EXPECT_TRUE(run.outcome.reports.empty());
}

}  // namespace
}  // namespace tsar
