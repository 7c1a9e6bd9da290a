// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"

#include <array>
#include <iostream>

#include <signal.h>
#include <unistd.h>

namespace tsar {

// During its lifetime, the first Ctrl-C (SIGINT), SIGTERM or SIGHUP, unless
// that is ignored, only sets a flag, so that the work can end cleanly; the
// second ends the program at once. One object at a time.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  bool Requested() const;

 private:
  static constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, kSignals.size()> previous_;
};

// Returns what the work returns. Its argument is a Progress that writes to
// standard error and stops where the program was interrupted.
template <typename Work>
auto RunInterruptibly(const Work& work) {
  Progress progress(std::cerr, isatty(STDERR_FILENO) != 0);
  const Interruption interruption;
  progress.SetStop([&] { return interruption.Requested(); });
  return work(progress);
}

}  // namespace tsar
