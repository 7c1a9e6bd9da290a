// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"

#include <system_error>
#include <thread>
#include <utility>

namespace tsar {

// That the system starts no more threads, and what to do about it.
Error NoMoreThreads(const std::system_error& error);

// Starts a thread. Throws kOutOfMemory where the system allows no more, or has
// no memory for it. Whoever starts several must see to it that those that run
// come to their end then: the vector that holds them joins them.
template <typename Function>
std::jthread StartThread(Function&& function) {
  try {
    return std::jthread(std::forward<Function>(function));
  } catch (const std::system_error& error) {
    throw NoMoreThreads(error);
  }
}

}  // namespace tsar
