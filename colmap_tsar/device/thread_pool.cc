// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/thread_pool.h"

#include "colmap_tsar/base/start_thread.h"

#include <algorithm>

namespace tsar {

ThreadPool::ThreadPool(int num_threads) {
  num_threads = tsar::NumThreads(num_threads);
  workers_.reserve(static_cast<size_t>(num_threads - 1));
  try {
    for (int i = 1; i < num_threads; ++i) {
      workers_.push_back(StartThread([this] { WorkerLoop(); }));
    }
  } catch (...) {
    Stop();
    throw;
  }
}

ThreadPool::~ThreadPool() { Stop(); }

void ThreadPool::Stop() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
}

void ThreadPool::Run(int64_t count,
                     const std::function<void(int64_t, int64_t)>& body) {
  if (count <= 0) {
    return;
  }
  if (workers_.empty() || count == 1) {
    body(0, count);
    return;
  }
  {
    std::lock_guard<std::mutex> lock(mutex_);
    body_ = &body;
    count_ = count;
    // Several pieces per thread balance iterations of unequal cost.
    piece_ = std::max<int64_t>(1, count / (8 * NumThreads()));
    next_ = 0;
    exception_ = nullptr;
    num_busy_ = static_cast<int>(workers_.size());
    ++generation_;
  }
  wake_.notify_all();
  WorkOnPieces();
  std::unique_lock<std::mutex> lock(mutex_);
  idle_.wait(lock, [this] { return num_busy_ == 0; });
  body_ = nullptr;
  if (exception_) {
    std::rethrow_exception(exception_);
  }
}

void ThreadPool::WorkerLoop() {
  uint64_t seen = 0;
  while (true) {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [&] { return stop_ || generation_ != seen; });
      if (stop_) {
        return;
      }
      seen = generation_;
    }
    WorkOnPieces();
    std::lock_guard<std::mutex> lock(mutex_);
    if (--num_busy_ == 0) {
      idle_.notify_one();
    }
  }
}

void ThreadPool::WorkOnPieces() {
  while (true) {
    int64_t begin = 0;
    int64_t end = 0;
    {
      std::lock_guard<std::mutex> lock(mutex_);
      if (next_ >= count_ || exception_) {
        return;
      }
      begin = next_;
      end = std::min(count_, begin + piece_);
      next_ = end;
    }
    try {
      (*body_)(begin, end);
    } catch (...) {
      std::lock_guard<std::mutex> lock(mutex_);
      if (!exception_) {
        exception_ = std::current_exception();
      }
    }
  }
}

}  // namespace tsar
