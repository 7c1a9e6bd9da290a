// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/file_time.h"

#include <sys/stat.h>

namespace tsar {

int64_t TimeOf(const std::filesystem::path& path) {
  struct stat state;
  if (stat(path.c_str(), &state) != 0) {
    return 0;
  }
  return ToNanoseconds(state.st_mtim);
}

int64_t ToNanoseconds(const timespec& time) {
  constexpr int64_t kPerSecond = 1000000000;
  return time.tv_sec * kPerSecond + time.tv_nsec;
}

}  // namespace tsar
