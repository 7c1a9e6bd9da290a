// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/image_pipeline.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <latch>
#include <numeric>
#include <set>
#include <sstream>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

using Outcome = ImageReport::Outcome;

constexpr size_t kViewBytes = 40;
constexpr int kNumSources = 5;

// Images whose result is the sum of the numbers of their views.
class DrawnTasks : public ImageTasks<int64_t> {
 public:
  explicit DrawnTasks(int num_images) : num_images_(num_images) {}

  ImageReport Begin(size_t index) override {
    ImageReport report;
    if (done_before.count(index) > 0) {
      report.outcome = Outcome::kSkipped;
    }
    return report;
  }
  std::vector<int> Views(size_t index) const override {
    std::vector<int> views;
    for (int i = 0; i <= kNumSources; ++i) {
      views.push_back((static_cast<int>(index) + 3 * i) % num_images_);
    }
    return views;
  }
  int64_t Compute(size_t index,
                  size_t worker,
                  ViewCache::Lease* views,
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
    const int count = ++num_results_;
    int before = max_results;
    while (before < count &&
           !max_results.compare_exchange_weak(before, count)) {
    }
    report->counts["computed"] = 1;
    is_busy_[worker] = false;
    return static_cast<int64_t>(sum);
  }
  bool WritesAfterStop() const override { return writes_after_stop; }
  void Write(size_t index, int64_t result, ImageReport* report) override {
    before_write(index);
    CheckFailure(fails_to_write, index);
    report->counts["sum"] = result;
    report->outcome = Outcome::kDone;
    --num_results_;
    ++num_written;
  }

  int64_t ExpectedSum(size_t index) const {
    int64_t sum = 0;
    for (const int image : Views(index)) {
      sum += image;
    }
    return sum;
  }

  std::set<size_t> done_before;
  std::set<size_t> fails_to_compute;
  std::set<size_t> fails_to_write;
  std::function<void(size_t)> before_compute = [](size_t) {};
  std::function<void(size_t)> before_write = [](size_t) {};
  bool writes_after_stop = false;
  std::atomic<int> num_written = 0;
  std::atomic<int> max_results = 0;

 private:
  void CheckFailure(const std::set<size_t>& failing, size_t index) const {
    if (failing.count(index) > 0) {
      throw Error(ErrorCode::kIo, std::to_string(index) + ": fails; repair it");
    }
  }

  const int num_images_;
  std::atomic<int> num_results_ = 0;
  std::array<std::atomic<bool>, 8> is_busy_ = {};
};

struct PipelineRun {
  explicit PipelineRun(int num_images) : tasks(num_images) {
    images.resize(static_cast<size_t>(num_images));
    std::iota(images.begin(), images.end(), size_t{0});
  }

  void Go() {
    ViewCache cache(max_views * kViewBytes, kViewBytes, [this](int image) {
      if (image == unreadable) {
        throw Error(ErrorCode::kCorrupt, "broken; repair it");
      }
      const int count = ++num_alive;
      int before = max_alive;
      while (before < count &&
             !max_alive.compare_exchange_weak(before, count)) {
      }
      auto view = std::make_shared<ViewData>();
      view->depth = Image<float>(10, 1, static_cast<float>(image));
      return ViewCache::View(view.get(),
                             [this, view](const ViewData*) { --num_alive; });
    });
    std::ostringstream text;
    Progress progress(text, false);
    PipelineOutcome outcome =
        ImagePipeline<int64_t>(
            tasks, images, "", cache, sizes, progress, should_stop)
            .Run(num_workers);
    reports = std::move(outcome.reports);
    failures = std::move(outcome.failures);
    first_failure = outcome.first_failure;
  }

  int NumFailures() const {
    return static_cast<int>(std::count_if(
        failures.begin(), failures.end(), [](const std::exception_ptr& f) {
          return f != nullptr;
        }));
  }
  int NumWith(Outcome outcome) const {
    return static_cast<int>(std::count_if(
        reports.begin(), reports.end(), [&](const ImageReport& report) {
          return report.outcome == outcome;
        }));
  }

  DrawnTasks tasks;
  std::vector<size_t> images;
  PipelineSizes sizes;
  size_t num_workers = 1;
  size_t max_views = 20;
  int unreadable = -1;
  std::function<bool()> should_stop = [] { return false; };
  std::atomic<int> num_alive = 0;
  std::atomic<int> max_alive = 0;
  std::vector<ImageReport> reports;
  std::vector<std::exception_ptr> failures;
  std::exception_ptr first_failure;
};

TEST(ImagePipeline, TheNumbersOfThreadsAndOfViewsChangeNothing) {
  constexpr int kNumImages = 60;
  for (const int num_threads : {1, 2, 5}) {
    for (const size_t max_views : {0, 6, 13, 1000}) {
      SCOPED_TRACE(std::to_string(num_threads) + " threads, " +
                   std::to_string(max_views) + " views");
      PipelineRun run(kNumImages);
      run.sizes = {num_threads, num_threads, 3, 2};
      run.num_workers = static_cast<size_t>(num_threads);
      run.max_views = max_views;
      run.tasks.done_before = {0, 17, 59};
      run.Go();
      EXPECT_EQ(run.NumFailures(), 0);
      EXPECT_EQ(run.NumWith(Outcome::kSkipped), 3);
      EXPECT_EQ(run.NumWith(Outcome::kDone), kNumImages - 3);
      for (size_t i = 0; i < kNumImages; ++i) {
        if (run.tasks.done_before.count(i) == 0) {
          EXPECT_EQ(run.reports[i].counts.at("sum"), run.tasks.ExpectedSum(i));
          EXPECT_EQ(run.reports[i].seconds.count("read"), 1u);
        }
      }
    }
  }
}

TEST(ImagePipeline, FiveThousandImagesNeedTheMemoryOfFew) {
  PipelineRun run(5000);
  run.sizes = {4, 2, 4, 2};
  run.num_workers = 4;
  run.Go();
  EXPECT_EQ(run.NumWith(Outcome::kDone), 5000);
  EXPECT_FALSE(run.first_failure);
  EXPECT_LE(run.max_alive, 20);
  // With the workers, in the queue, with the writers.
  EXPECT_LE(run.tasks.max_results, 4 + 2 + 2);
  EXPECT_EQ(run.num_alive, 0);
}

TEST(ImagePipeline, AnImageThatCannotBeReadLeavesThoseBeforeItDone) {
  PipelineRun run(40);
  run.sizes = {3, 2, 4, 2};
  run.num_workers = 3;
  run.unreadable = 27;
  run.Go();
  // The first that needs view 27 is 27 - 3 * kNumSources.
  constexpr size_t kFirst = 27 - 3 * kNumSources;
  for (size_t i = 0; i < kFirst; ++i) {
    EXPECT_EQ(run.reports[i].outcome, Outcome::kDone) << i;
    EXPECT_FALSE(run.failures[i]) << i;
  }
  EXPECT_TRUE(run.failures[kFirst]);
  EXPECT_EQ(run.reports[kFirst].outcome, Outcome::kNotDone);
  // Those at work were taken to their end, and no others begun.
  EXPECT_LT(run.NumWith(Outcome::kDone), 35);
  EXPECT_EQ(run.num_alive, 0);
}

TEST(ImagePipeline, FailuresOfWorkersAndWritersEndTheRun) {
  for (const int num_threads : {1, 2}) {
    for (const bool writes : {false, true}) {
      PipelineRun run(500);
      run.sizes = {num_threads, num_threads, 2, 2};
      run.num_workers = static_cast<size_t>(num_threads);
      (writes ? run.tasks.fails_to_write : run.tasks.fails_to_compute) = {7};
      run.Go();
      ASSERT_TRUE(run.failures[7]);
      EXPECT_EQ(run.first_failure, run.failures[7]);
      ExpectError(ErrorCode::kIo, {"7: fails"}, [&] {
        std::rethrow_exception(run.failures[7]);
      });
      EXPECT_EQ(run.NumFailures(), 1);
      EXPECT_EQ(run.NumWith(Outcome::kDone), run.tasks.num_written);
      for (size_t i = 0; i < 7; ++i) {
        EXPECT_EQ(run.reports[i].outcome, Outcome::kDone) << i;
      }
      // Those that were at work: with the loader and ready, and where a writer
      // fails also with the worker and finished. Of several threads one may
      // sleep on its failure for as long as it likes.
      if (num_threads == 1) {
        EXPECT_LE(run.tasks.num_written, 7 + (writes ? 1 + 2 + 1 + 2 : 1 + 2));
      }
    }
  }
}

TEST(ImagePipeline, TellsTheFailureThatCameFirst) {
  PipelineRun run(40);
  run.sizes = {1, 1, 2, 2};
  run.num_workers = 2;
  run.max_views = 1000;
  run.tasks.fails_to_write = {7};
  run.tasks.fails_to_compute = {5};
  // Image 5 fails after the only writer has gone on from its failure with 7.
  std::latch begun(1);
  std::latch failed(1);
  run.tasks.before_compute = [&](size_t index) {
    if (index == 5) {
      failed.wait();
    } else if (index == 8) {
      begun.count_down();
    }
  };
  run.tasks.before_write = [&](size_t index) {
    if (index == 7) {
      begun.wait();
    } else if (index == 8) {
      failed.count_down();
    }
  };
  run.Go();
  EXPECT_EQ(run.NumFailures(), 2);
  ASSERT_TRUE(run.failures[5]);
  ASSERT_TRUE(run.failures[7]);
  EXPECT_EQ(run.first_failure, run.failures[7]);
}

TEST(ImagePipeline, StopsInTheMiddle) {
  constexpr int kNumImages = 300;
  for (const int num_threads : {1, 3}) {
    PipelineRun run(kNumImages);
    run.sizes = {num_threads, num_threads, 2, 2};
    run.num_workers = static_cast<size_t>(num_threads);
    run.should_stop = [&] { return run.tasks.num_written >= 20; };
    run.Go();
    EXPECT_EQ(run.NumFailures(), 0);
    EXPECT_GE(run.tasks.num_written, 20);
    // A writer that had asked before the twentieth was done.
    EXPECT_LE(run.tasks.num_written, 20 + num_threads - 1);
    EXPECT_EQ(run.NumWith(Outcome::kDone), run.tasks.num_written);
    EXPECT_EQ(run.num_alive, 0);
  }
}

TEST(ImagePipeline, WritesWhatIsWithAWorkerIfTheTasksSaySo) {
  PipelineRun run(300);
  run.tasks.writes_after_stop = true;
  std::atomic<bool> is_stopped = false;
  run.tasks.before_compute = [&](size_t index) { is_stopped = index == 20; };
  run.should_stop = [&] { return is_stopped.load(); };
  run.Go();
  EXPECT_EQ(run.tasks.num_written, 21);
  EXPECT_EQ(run.NumWith(Outcome::kDone), 21);
}

TEST(ImagePipeline, TakesTheImagesThatItIsGiven) {
  PipelineRun run(30);
  run.images = {3, 11, 12, 28};
  run.tasks.fails_to_write = {12};
  run.Go();
  ASSERT_EQ(run.reports.size(), 4u);
  for (const size_t place : {0, 1}) {
    EXPECT_EQ(run.reports[place].counts.at("sum"),
              run.tasks.ExpectedSum(run.images[place]));
  }
  EXPECT_TRUE(run.failures[2]);
  EXPECT_EQ(run.reports[2].outcome, Outcome::kNotDone);
}

TEST(ImagePipeline, WorksWithoutImages) {
  PipelineRun run(0);
  run.Go();
  EXPECT_TRUE(run.reports.empty());
}

}  // namespace
}  // namespace tsar
