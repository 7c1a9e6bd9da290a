// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <mutex>

#include <opencv2/core.hpp>

namespace tsar {

// Disables OpenCV's own threads while an object lives: images are processed in
// parallel, with which these would compete, and OpenCV reports a failure to
// start threads badly. The setting is global, so that the last object restores
// it.
class OpenCvWithoutThreads {
 public:
  OpenCvWithoutThreads() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (num_alive_++ == 0) {
      num_threads_before_ = cv::getNumThreads();
      cv::setNumThreads(1);
    }
  }
  ~OpenCvWithoutThreads() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (--num_alive_ == 0) {
      cv::setNumThreads(num_threads_before_);
    }
  }
  OpenCvWithoutThreads(const OpenCvWithoutThreads&) = delete;
  OpenCvWithoutThreads& operator=(const OpenCvWithoutThreads&) = delete;

 private:
  static inline std::mutex mutex_;
  static inline int num_alive_ = 0;
  static inline int num_threads_before_ = 0;
};

}  // namespace tsar
