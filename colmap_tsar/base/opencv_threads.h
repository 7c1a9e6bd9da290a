// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <mutex>

namespace tsar {

// While one of these lives, OpenCV uses no threads of its own: images are
// worked on side by side, and its threads would only compete with them; and
// where the system starts no more threads, the library that it has them from
// cannot say so well. The number is the whole process's, so that the last one
// puts it back.
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
