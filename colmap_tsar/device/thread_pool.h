// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace tsar {

// Worker threads for loops whose iterations are independent. The split of the
// range never changes what an iteration computes, so results do not depend on
// the number of threads.
class ThreadPool {
 public:
  // num_threads < 1 means one per core. Throws kOutOfMemory if the system does
  // not start as many.
  explicit ThreadPool(int num_threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int NumThreads() const { return static_cast<int>(workers_.size()) + 1; }

  // Calls body(begin, end) for consecutive pieces of [0, count) until all are
  // done; the calling thread works too. The first exception of a piece is
  // rethrown here. Not to be called from within a body.
  void Run(int64_t count, const std::function<void(int64_t, int64_t)>& body);

  // Calls function(i) for each i in [0, count), as Run().
  template <typename Function>
  void ForEach(size_t count, const Function& function) {
    Run(static_cast<int64_t>(count), [&](int64_t begin, int64_t end) {
      for (int64_t i = begin; i < end; ++i) {
        function(static_cast<size_t>(i));
      }
    });
  }

 private:
  // Ends the workers.
  void Stop();
  void WorkerLoop();
  void WorkOnPieces();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable idle_;
  const std::function<void(int64_t, int64_t)>* body_ = nullptr;
  int64_t count_ = 0;
  int64_t piece_ = 1;
  int64_t next_ = 0;
  int num_busy_ = 0;
  uint64_t generation_ = 0;
  bool stop_ = false;
  std::exception_ptr exception_;
  // The last member, so that the workers end before the members they use.
  std::vector<std::jthread> workers_;
};

}  // namespace tsar
