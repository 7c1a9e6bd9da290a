// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/file_size_limit.h"

namespace tsar {

FileSizeLimitFails::FileSizeLimitFails() {
  struct sigaction action = {};
  action.sa_handler = SIG_IGN;
  sigemptyset(&action.sa_mask);
  sigaction(SIGXFSZ, &action, &previous_);
}

FileSizeLimitFails::~FileSizeLimitFails() {
  sigaction(SIGXFSZ, &previous_, nullptr);
}

}  // namespace tsar
