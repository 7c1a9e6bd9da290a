// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/opencv_threads.h"

#include <opencv2/core.hpp>

namespace tsar {

OpenCvWithoutThreads::OpenCvWithoutThreads() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (num_alive_++ == 0) {
    num_threads_before_ = cv::getNumThreads();
    cv::setNumThreads(1);
  }
}

OpenCvWithoutThreads::~OpenCvWithoutThreads() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (--num_alive_ == 0) {
    cv::setNumThreads(num_threads_before_);
  }
}

}  // namespace tsar
