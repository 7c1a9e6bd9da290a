// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/image_pipeline.h"

#include "colmap_tsar/base/start_thread.h"

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

namespace tsar {

ImagePipeline::ImagePipeline(ImageTasks& tasks,
                             ViewCache& cache,
                             const PipelineSizes& sizes,
                             Progress& progress,
                             const std::function<bool()>& should_stop)
    : tasks_(tasks),
      cache_(cache),
      sizes_(sizes),
      progress_(progress),
      should_stop_(should_stop),
      ready_(sizes.max_ready),
      finished_(sizes.max_finished),
      reports_(tasks.NumImages()),
      failures_(tasks.NumImages()) {}

void ImagePipeline::Run(size_t num_workers) {
  progress_.Start(static_cast<int>(tasks_.NumImages()), tasks_.PassName());
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
      // The system gives no more threads: those that there are shall end.
      has_failed_ = true;
      ready_.Close();
      finished_.Close();
      throw;
    }
  }
  progress_.Finish();
}

void ImagePipeline::LoadImages() {
  while (!has_failed_ && !should_stop_()) {
    const size_t index = next_++;
    if (index >= tasks_.NumImages()) {
      break;
    }
    Try(index, [&] { LoadOne(index); });
  }
  if (--num_loading_ == 0) {
    ready_.Close();
  }
}

void ImagePipeline::LoadOne(size_t index) {
  ReadyImage image;
  image.index = index;
  image.report = tasks_.Begin(index);
  if (image.report.outcome != ImageReport::Outcome::kNotDone) {
    Report(index, std::move(image.report));
    return;
  }
  image.views = cache_.Reserve(tasks_.Views(index));
  const auto start = std::chrono::steady_clock::now();
  if (!image.views.Load(should_stop_)) {
    return;
  }
  image.report.seconds["read"] +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
          .count();
  tasks_.Prepare(index, image.views);
  ready_.Push(std::move(image));
}

void ImagePipeline::ComputeImages(size_t worker) {
  while (std::optional<ReadyImage> image = ready_.Pop()) {
    if (should_stop_()) {
      continue;
    }
    Try(image->index, [&] {
      FinishedImage finished;
      finished.index = image->index;
      finished.report = std::move(image->report);
      finished.result =
          tasks_.Compute(image->index, worker, &image->views, &finished.report);
      image->views = {};
      finished_.Push(std::move(finished));
    });
  }
  if (--num_computing_ == 0) {
    finished_.Close();
  }
}

void ImagePipeline::WriteImages() {
  while (std::optional<FinishedImage> image = finished_.Pop()) {
    if (should_stop_()) {
      continue;
    }
    Try(image->index, [&] {
      tasks_.Write(image->index, std::move(image->result), &image->report);
      Report(image->index, std::move(image->report));
    });
  }
}

template <typename Function>
void ImagePipeline::Try(size_t index, Function function) {
  try {
    function();
  } catch (...) {
    failures_[index] = std::current_exception();
    if (!has_failed_.exchange(true)) {
      first_failure_ = failures_[index];
    }
  }
}

void ImagePipeline::Report(size_t index, ImageReport report) {
  const bool was_work = report.outcome == ImageReport::Outcome::kRefined;
  reports_[index] = std::move(report);
  progress_.Advance(was_work);
}

}  // namespace tsar
