// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/interruption.h"

#include <atomic>

namespace tsar {
namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void SetRequested(int /*signal*/) { requested = true; }

}  // namespace

Interruption::Interruption() {
  requested = false;
  struct sigaction action = {};
  action.sa_handler = &SetRequested;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  for (size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], &action, &previous_[i]);
  }
  // With nohup, the work goes on when its terminal is closed.
  if (previous_.back().sa_handler == SIG_IGN) {
    sigaction(kSignals.back(), &previous_.back(), nullptr);
  }
}

Interruption::~Interruption() {
  for (size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], &previous_[i], nullptr);
  }
}

bool Interruption::Requested() const { return requested; }

}  // namespace tsar
