// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <signal.h>

namespace tsar {

// While it lives, a write past the limit of a file's size (ulimit -f) fails, as
// one to a full disk does; the system would end the process otherwise.
class FileSizeLimitFails {
 public:
  FileSizeLimitFails();
  ~FileSizeLimitFails();
  FileSizeLimitFails(const FileSizeLimitFails&) = delete;
  FileSizeLimitFails& operator=(const FileSizeLimitFails&) = delete;

 private:
  struct sigaction previous_;
};

}  // namespace tsar
