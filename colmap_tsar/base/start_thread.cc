// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/start_thread.h"

namespace tsar {

Error NoMoreThreads(const std::system_error& error) {
  return Error(ErrorCode::kOutOfMemory,
               "no more threads can be started (" + error.code().message() +
                   "); raise the limits of processes (ulimit -u) and memory "
                   "(ulimit -v), or give a smaller num_threads");
}

}  // namespace tsar
