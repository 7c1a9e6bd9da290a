// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/device/thread_pool.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace tsar {

// Calls function(i, device) for each i in [0, count), max_at_a_time at most in
// parallel. device: the CPU, with an equal share of the threads.
template <typename Function>
void ForEachView(size_t count,
                 int max_at_a_time,
                 int num_threads,
                 const Function& function) {
  const int at_a_time = std::max(
      1, std::min({max_at_a_time, num_threads, static_cast<int>(count)}));
  ThreadPool pool(at_a_time);
  pool.Run(static_cast<int64_t>(count), [&](int64_t begin, int64_t end) {
    const std::unique_ptr<Device> device =
        Device::CreateCpu(std::max(1, num_threads / at_a_time));
    for (int64_t i = begin; i < end; ++i) {
      function(static_cast<size_t>(i), *device);
    }
  });
}

}  // namespace tsar
