// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/base/start_thread.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/shared_cache.h"
#include "colmap_tsar/view/view_data.h"

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace tsar {

// The views of an image at work, in main memory.
template <typename View>
class ViewsAtWork {
 public:
  void Add(int image, std::shared_ptr<const View> view) {
    views_[image] = std::move(view);
  }
  // Of an image that was added and has not been released.
  const View& Get(int image) const { return *views_.at(image); }
  std::shared_ptr<const View> Share(int image) const {
    return views_.at(image);
  }
  void Release(int image) { views_.erase(image); }

 private:
  std::map<int, std::shared_ptr<const View>> views_;
};

using LoadedViews = ViewsAtWork<ViewData>;

// The work of one pass on each image of a run, as called by an ImagePipeline.
// Images have indices from 0 on. Calls for one image are sequential, those for
// different images come from several threads at once. Result: the data that
// Compute() passes to Write(). View: what is read of each image.
template <typename Result, typename View = ViewData>
class ImagePass {
 public:
  virtual ~ImagePass() = default;

  // Runs before any map is read. The outcome is kNotDone if Compute() is still
  // needed.
  virtual ImageReport Begin(size_t index) = 0;
  // The views that Compute() needs, as images of the sparse model.
  virtual std::vector<int> Views(size_t index) const = 0;
  virtual std::shared_ptr<const View> Load(int image) const = 0;
  // Work on the CPU that needs no worker.
  virtual void Prepare(size_t /*index*/) {}
  // Computes with one of the workers, each of which is used by one thread at a
  // time. Releases views as early as possible.
  virtual Result Compute(size_t index,
                         size_t worker,
                         ViewsAtWork<View>* views,
                         ImageReport* report) = 0;
  // Whether images that a worker holds or has computed when the user asks to
  // stop are still written, since computing them took long.
  virtual bool WritesAfterStop() const { return false; }
  // Writes the result and sets the outcome.
  virtual void Write(size_t index, Result result, ImageReport* report) = 0;
};

// Reads, computes and writes images, concurrently for different images: each
// thread takes one image at a time through all steps, and waits for a free
// worker to compute. Images are begun in their order.
template <typename Result, typename View = ViewData>
class ImagePipeline {
 public:
  // All references must outlive this object. images: their indices; the outcome
  // is in their order. pass_name: for the user; empty if there is only one
  // pass. max_num_views: how many views are kept in memory.
  ImagePipeline(ImagePass<Result, View>& pass,
                std::vector<size_t> images,
                std::string pass_name,
                const ImagesAtWork& at_work,
                size_t max_num_views,
                Progress& progress)
      : pass_(pass),
        images_(std::move(images)),
        pass_name_(std::move(pass_name)),
        num_threads_(at_work.num_threads),
        progress_(progress),
        cache_(max_num_views),
        free_workers_(static_cast<size_t>(at_work.num_workers)),
        outcome_(images_.size()) {
    std::iota(free_workers_.begin(), free_workers_.end(), size_t{0});
    for (const size_t index : images_) {
      for (const int image : pass_.Views(index)) {
        ++num_uses_[image];
      }
    }
  }

  // Returns when all images are done. After a failure no further image is
  // begun, but those already begun are completed. Where the user asks to
  // stop, images that are not being written are left as they were; or, if
  // WritesAfterStop(), only those that have not reached a worker.
  PipelineOutcome Run();

 private:
  // Exclusive use of the worker that was idle longest, which the constructor
  // waits for.
  class Loan {
   public:
    explicit Loan(ImagePipeline& pipeline) : pipeline_(pipeline) {
      std::unique_lock<std::mutex> lock(pipeline_.mutex_);
      pipeline_.is_free_.wait(lock,
                              [&] { return !pipeline_.free_workers_.empty(); });
      worker_ = pipeline_.free_workers_.front();
      pipeline_.free_workers_.pop_front();
    }
    ~Loan() {
      const std::lock_guard<std::mutex> lock(pipeline_.mutex_);
      pipeline_.free_workers_.push_back(worker_);
      pipeline_.is_free_.notify_one();
    }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;

    size_t Worker() const { return worker_; }

   private:
    ImagePipeline& pipeline_;
    size_t worker_ = 0;
  };

  void WorkOnImages();
  // If the outcome is still kNotDone, the user asked to stop.
  void WorkOn(size_t index, ImageReport* report);
  // Returns false if the user asked to stop.
  bool Load(size_t index, ViewsAtWork<View>* views);
  // Drops the views that no later image needs.
  void DropViews(size_t index);

  ImagePass<Result, View>& pass_;
  const std::vector<size_t> images_;
  const std::string pass_name_;
  const int num_threads_;
  Progress& progress_;
  SharedCache<View> cache_;
  std::mutex mutex_;
  std::condition_variable is_free_;
  std::deque<size_t> free_workers_;
  std::map<int, int> num_uses_;  // Of each view, by images to come.
  std::atomic<size_t> next_ = 0;
  std::atomic<bool> has_failed_ = false;
  // The entries of an image are written by the thread that works on it, the
  // first failure by the thread that sets has_failed_.
  PipelineOutcome outcome_;
};

template <typename Result, typename View>
PipelineOutcome ImagePipeline<Result, View>::Run() {
  progress_.Start(static_cast<int>(images_.size()), pass_name_);
  {
    std::vector<std::jthread> threads;
    threads.reserve(static_cast<size_t>(num_threads_));
    try {
      for (int i = 0; i < num_threads_; ++i) {
        threads.push_back(StartThread([this] { WorkOnImages(); }));
      }
    } catch (...) {
      // The system provides no more threads: stop the running ones.
      has_failed_ = true;
      throw;
    }
  }
  progress_.Finish();
  return std::move(outcome_);
}

template <typename Result, typename View>
void ImagePipeline<Result, View>::WorkOnImages() {
  while (!has_failed_ && !progress_.ShouldStop()) {
    const size_t place = next_++;
    if (place >= images_.size()) {
      return;
    }
    try {
      ImageReport report;
      WorkOn(images_[place], &report);
      if (report.outcome != ImageReport::Outcome::kNotDone) {
        const bool was_work = report.outcome == ImageReport::Outcome::kDone;
        outcome_.reports[place] = std::move(report);
        progress_.Advance(was_work);
      }
    } catch (...) {
      outcome_.failures[place] = std::current_exception();
      if (!has_failed_.exchange(true)) {
        outcome_.first_failure = outcome_.failures[place];
      }
    }
  }
}

template <typename Result, typename View>
void ImagePipeline<Result, View>::WorkOn(size_t index, ImageReport* report) {
  *report = pass_.Begin(index);
  if (report->outcome != ImageReport::Outcome::kNotDone) {
    DropViews(index);
    return;
  }
  ViewsAtWork<View> views;
  const Stopwatch reading;
  if (!Load(index, &views)) {
    return;
  }
  report->seconds["read"] += reading.Seconds();
  pass_.Prepare(index);
  Result result;
  {
    const Loan loan(*this);
    if (progress_.ShouldStop()) {
      return;
    }
    result = pass_.Compute(index, loan.Worker(), &views, report);
  }
  views = {};
  DropViews(index);
  if (!progress_.ShouldStop() || pass_.WritesAfterStop()) {
    pass_.Write(index, std::move(result), report);
  }
}

template <typename Result, typename View>
bool ImagePipeline<Result, View>::Load(size_t index, ViewsAtWork<View>* views) {
  const std::vector<int> images = pass_.Views(index);
  auto loaded = cache_.GetAll(
      images,
      [&](int image) { return pass_.Load(image); },
      [&] { return progress_.ShouldStop(); });
  for (size_t i = 0; i < images.size(); ++i) {
    if (!loaded[i]) {
      return false;
    }
    views->Add(images[i], std::move(loaded[i]));
  }
  return true;
}

template <typename Result, typename View>
void ImagePipeline<Result, View>::DropViews(size_t index) {
  for (const int image : pass_.Views(index)) {
    const bool was_last = [&] {
      const std::lock_guard<std::mutex> lock(mutex_);
      return --num_uses_[image] == 0;
    }();
    if (was_last) {
      cache_.Drop(image);
    }
  }
}

}  // namespace tsar
