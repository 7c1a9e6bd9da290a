// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"

#include <system_error>
#include <thread>
#include <utility>

namespace tsar {

// The error for a failure to start a thread, with advice.
Error NoMoreThreads(const std::system_error& error);

// Starts a thread. Throws kOutOfMemory if the system allows no more or has no
// memory for it. The caller must make sure that other running threads end then:
// the vector that holds them joins them.
template <typename Function>
std::jthread StartThread(Function&& function) {
  try {
    return std::jthread(std::forward<Function>(function));
  } catch (const std::system_error& error) {
    throw NoMoreThreads(error);
  }
}

}  // namespace tsar
