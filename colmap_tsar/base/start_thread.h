// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <system_error>
#include <thread>
#include <utility>

namespace tsar {

// The requested number of threads if it is positive, else one per core.
inline int NumThreads(int wanted) {
  return wanted > 0
             ? wanted
             : std::max(1,
                        static_cast<int>(std::thread::hardware_concurrency()));
}

// Starts a thread. Throws kOutOfMemory if the system allows no more or has no
// memory for it. The caller must make sure that the threads already running end
// then: the vector that holds them joins them.
template <typename Function>
std::jthread StartThread(Function&& function) {
  try {
    return std::jthread(std::forward<Function>(function));
  } catch (const std::system_error& error) {
    throw Error(ErrorCode::kOutOfMemory,
                "no more threads can be started (" + error.code().message() +
                    "); raise the limits of processes (ulimit -u) and memory "
                    "(ulimit -v), or give a smaller num_threads");
  }
}

}  // namespace tsar
