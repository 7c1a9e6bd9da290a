// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/controllers/bounded_queue.h"
#include "colmap_tsar/controllers/run_summary.h"
#include "colmap_tsar/controllers/view_cache.h"
#include "colmap_tsar/pipeline/refine_image.h"

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace tsar {

// What is to be done with the images of a run, numbered from 0 on. The calls
// for one image come one after the other, those for different images from
// several threads at once.
class ImageTasks {
 public:
  virtual ~ImageTasks() = default;

  virtual size_t NumImages() const = 0;
  // For the user; empty where there is one pass only.
  virtual std::string PassName() const { return ""; }
  // Does what can be done without reading the image's maps. Where that is all,
  // the outcome tells what it was; otherwise it is kNotDone.
  virtual ImageReport Begin(size_t index) = 0;
  // The views that Compute() needs.
  virtual std::vector<int> Views(size_t index) const = 0;
  // What can be done on the CPU once the views are there, so that no worker
  // needs to do it.
  virtual void Prepare(size_t /*index*/, const ViewCache::Lease& /*views*/) {}
  // With one of the workers, each of which is used by one thread. Gives views
  // back as early as it can.
  virtual RefineResult Compute(size_t index,
                               size_t worker,
                               ViewCache::Lease* views,
                               ImageReport* report) = 0;
  virtual void Write(size_t index,
                     RefineResult result,
                     ImageReport* report) = 0;
};

// How many threads read and write, and how many images may wait between them.
struct PipelineSizes {
  int num_loaders = 1;
  int num_writers = 1;
  size_t max_ready = 1;     // Read, not yet with a worker.
  size_t max_finished = 1;  // Computed, not yet with a writer.
};

// Takes all images through reading, computing and writing, so that the three go
// on at the same time for different images. Images are begun in their order.
class ImagePipeline {
 public:
  // All references must outlive this object. should_stop is asked, from all
  // threads, whether the user wants to end.
  ImagePipeline(ImageTasks& tasks,
                ViewCache& cache,
                const PipelineSizes& sizes,
                Progress& progress,
                const std::function<bool()>& should_stop);

  // Returns when all images are done. After a failure no further image is
  // begun, but those at work are taken to their end. After should_stop, images
  // that are not being written are left as they were.
  void Run(size_t num_workers);

  // For each image: what became of it, and its failure where it had one.
  const std::vector<ImageReport>& Reports() const { return reports_; }
  const std::vector<std::exception_ptr>& Failures() const { return failures_; }
  // The failure that came first in time, of which others may be consequences;
  // null where there was none.
  std::exception_ptr FirstFailure() const { return first_failure_; }

 private:
  struct ReadyImage {
    size_t index = 0;
    ImageReport report;
    ViewCache::Lease views;
  };
  struct FinishedImage {
    size_t index = 0;
    ImageReport report;
    RefineResult result;
  };

  void LoadImages();
  void ComputeImages(size_t worker);
  void WriteImages();
  void LoadOne(size_t index);
  // Notes an exception of the function as the image's failure.
  template <typename Function>
  void Try(size_t index, Function function);
  void Report(size_t index, ImageReport report);

  ImageTasks& tasks_;
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
  // One element for each image, written by the thread that has the image.
  std::vector<ImageReport> reports_;
  std::vector<std::exception_ptr> failures_;
  // Written by the thread that sets has_failed_.
  std::exception_ptr first_failure_;
};

}  // namespace tsar
