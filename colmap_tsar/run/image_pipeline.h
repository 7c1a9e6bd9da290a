// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/base/start_thread.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/run/bounded_queue.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/view_cache.h"

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace tsar {

// The work of one pass on each image of a run, as called by an ImagePipeline.
// Images have indices from 0 on. Calls for one image are sequential, those for
// different images come from several threads at once. Result: the data that
// Compute() passes to Write().
template <typename Result>
class ImageTasks {
 public:
  virtual ~ImageTasks() = default;

  // Does the work that needs no maps. The outcome is kNotDone where the image
  // is still to be computed.
  virtual ImageReport Begin(size_t index) = 0;
  // The views that Compute() needs.
  virtual std::vector<int> Views(size_t index) const = 0;
  // Work on the CPU that needs the views but no worker.
  virtual void Prepare(size_t /*index*/, const ViewCache::Lease& /*views*/) {}
  // Computes with one of the workers, each of which is used by one thread.
  // Releases views as early as possible.
  virtual Result Compute(size_t index,
                         size_t worker,
                         ViewCache::Lease* views,
                         ImageReport* report) = 0;
  // Whether images that a worker holds or has computed when the user asks to
  // stop are still written, since computing them took long.
  virtual bool WritesAfterStop() const { return false; }
  // Writes the result and sets the outcome.
  virtual void Write(size_t index, Result result, ImageReport* report) = 0;
};

// The numbers of reading and writing threads, and of images that may wait.
struct PipelineSizes {
  int num_loaders = 1;
  int num_writers = 1;
  size_t max_ready = 1;     // Read, waiting for a worker.
  size_t max_finished = 1;  // Computed, waiting for a writer.
};

// Reads, computes and writes images, concurrently for different images. Images
// are begun in their order.
template <typename Result>
class ImagePipeline {
 public:
  // All references must outlive this object. images: the tasks' indices of the
  // images; the outcome is in their order. pass_name: for the user; empty where
  // there is one pass only. should_stop: whether the user wants to end; called
  // from all threads.
  ImagePipeline(ImageTasks<Result>& tasks,
                std::vector<size_t> images,
                std::string pass_name,
                ViewCache& cache,
                const PipelineSizes& sizes,
                Progress& progress,
                const std::function<bool()>& should_stop)
      : tasks_(tasks),
        images_(std::move(images)),
        pass_name_(std::move(pass_name)),
        cache_(cache),
        sizes_(sizes),
        progress_(progress),
        should_stop_(should_stop),
        ready_(sizes.max_ready),
        finished_(sizes.max_finished),
        outcome_(images_.size()) {}

  // Returns when all images are done. After a failure no further image is
  // begun, but those already begun are completed. After should_stop, images
  // that are not being written are left as they were; or, if WritesAfterStop(),
  // only those that have not reached a worker.
  PipelineOutcome Run(size_t num_workers);

 private:
  // place: the index in images_.
  struct ReadyImage {
    size_t place = 0;
    ImageReport report;
    ViewCache::Lease views;
  };
  struct FinishedImage {
    size_t place = 0;
    ImageReport report;
    Result result;
  };

  void LoadImages();
  void ComputeImages(size_t worker);
  void WriteImages();
  void LoadOne(size_t place);
  // Notes an exception of the function as the image's failure.
  template <typename Function>
  void Try(size_t place, Function function);
  void Report(size_t place, ImageReport report);

  ImageTasks<Result>& tasks_;
  const std::vector<size_t> images_;
  const std::string pass_name_;
  ViewCache& cache_;
  const PipelineSizes sizes_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
  BoundedQueue<ReadyImage> ready_;
  BoundedQueue<FinishedImage> finished_;
  std::atomic<size_t> next_ = 0;
  std::atomic<bool> has_failed_ = false;
  std::atomic<int> num_loading_ = 0;
  std::atomic<size_t> num_computing_ = 0;
  // The entries of an image are written by the thread that holds it, the first
  // failure by the thread that sets has_failed_.
  PipelineOutcome outcome_;
};

template <typename Result>
PipelineOutcome ImagePipeline<Result>::Run(size_t num_workers) {
  progress_.Start(static_cast<int>(images_.size()), pass_name_);
  num_loading_ = sizes_.num_loaders;
  num_computing_ = num_workers;
  {
    std::vector<std::jthread> threads;
    threads.reserve(static_cast<size_t>(sizes_.num_writers) + num_workers +
                    static_cast<size_t>(sizes_.num_loaders));
    try {
      for (int i = 0; i < sizes_.num_writers; ++i) {
        threads.push_back(StartThread([this] { WriteImages(); }));
      }
      for (size_t i = 0; i < num_workers; ++i) {
        threads.push_back(StartThread([this, i] { ComputeImages(i); }));
      }
      for (int i = 0; i < sizes_.num_loaders; ++i) {
        threads.push_back(StartThread([this] { LoadImages(); }));
      }
    } catch (...) {
      // The system provides no more threads: the running ones are to end.
      has_failed_ = true;
      ready_.Close();
      finished_.Close();
      throw;
    }
  }
  progress_.Finish();
  return std::move(outcome_);
}

template <typename Result>
void ImagePipeline<Result>::LoadImages() {
  while (!has_failed_ && !should_stop_()) {
    const size_t place = next_++;
    if (place >= images_.size()) {
      break;
    }
    Try(place, [&] { LoadOne(place); });
  }
  if (--num_loading_ == 0) {
    ready_.Close();
  }
}

template <typename Result>
void ImagePipeline<Result>::LoadOne(size_t place) {
  ReadyImage image;
  image.place = place;
  image.report = tasks_.Begin(images_[place]);
  if (image.report.outcome != ImageReport::Outcome::kNotDone) {
    Report(place, std::move(image.report));
    return;
  }
  image.views = cache_.Reserve(tasks_.Views(images_[place]));
  const Stopwatch reading;
  if (!image.views.Load(should_stop_)) {
    return;
  }
  image.report.seconds["read"] += reading.Seconds();
  tasks_.Prepare(images_[place], image.views);
  ready_.Push(std::move(image));
}

template <typename Result>
void ImagePipeline<Result>::ComputeImages(size_t worker) {
  while (std::optional<ReadyImage> image = ready_.Pop()) {
    if (should_stop_()) {
      continue;
    }
    Try(image->place, [&] {
      FinishedImage finished;
      finished.place = image->place;
      finished.report = std::move(image->report);
      finished.result = tasks_.Compute(
          images_[image->place], worker, &image->views, &finished.report);
      image->views = {};
      finished_.Push(std::move(finished));
    });
  }
  if (--num_computing_ == 0) {
    finished_.Close();
  }
}

template <typename Result>
void ImagePipeline<Result>::WriteImages() {
  while (std::optional<FinishedImage> image = finished_.Pop()) {
    if (should_stop_() && !tasks_.WritesAfterStop()) {
      continue;
    }
    Try(image->place, [&] {
      tasks_.Write(
          images_[image->place], std::move(image->result), &image->report);
      Report(image->place, std::move(image->report));
    });
  }
}

template <typename Result>
template <typename Function>
void ImagePipeline<Result>::Try(size_t place, Function function) {
  try {
    function();
  } catch (...) {
    outcome_.failures[place] = std::current_exception();
    if (!has_failed_.exchange(true)) {
      outcome_.first_failure = outcome_.failures[place];
    }
  }
}

template <typename Result>
void ImagePipeline<Result>::Report(size_t place, ImageReport report) {
  const bool was_work = report.outcome == ImageReport::Outcome::kDone;
  outcome_.reports[place] = std::move(report);
  progress_.Advance(was_work);
}

}  // namespace tsar
