// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <mutex>

namespace tsar {

// Disables OpenCV's own threads while an object lives: images are processed in
// parallel, with which these would compete, and OpenCV reports a failure to
// start threads badly. The setting is global, so that the last object restores
// it.
class OpenCvWithoutThreads {
 public:
  OpenCvWithoutThreads();
  ~OpenCvWithoutThreads();
  OpenCvWithoutThreads(const OpenCvWithoutThreads&) = delete;
  OpenCvWithoutThreads& operator=(const OpenCvWithoutThreads&) = delete;

 private:
  static inline std::mutex mutex_;
  static inline int num_alive_ = 0;
  static inline int num_threads_before_ = 0;
};

}  // namespace tsar
