// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <future>
#include <system_error>
#include <thread>
#include <vector>

namespace tsar {

// Calls body(begin, end) for consecutive blocks that cover [0, count), on all
// CPU cores in parallel, or fewer if the system starts no more threads, and
// returns when all are done. An exception of a body is rethrown. The
// evaluation's loops run over points, not over images, and need no device.
inline void ParallelBlocks(size_t count,
                           const std::function<void(size_t, size_t)>& body) {
  const size_t num_threads =
      std::max<size_t>(1, std::thread::hardware_concurrency());
  const size_t block = count / num_threads + 1;
  std::vector<std::future<void>> blocks;
  for (size_t begin = 0; begin < count; begin += block) {
    const size_t end = std::min(begin + block, count);
    try {
      blocks.push_back(std::async(std::launch::async, body, begin, end));
    } catch (const std::system_error&) {
      body(begin, end);
    }
  }
  for (std::future<void>& finished : blocks) {
    finished.get();
  }
}

}  // namespace tsar
