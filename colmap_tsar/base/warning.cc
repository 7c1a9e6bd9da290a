// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/warning.h"

#include "colmap_tsar/base/printable.h"

#include <glog/logging.h>

namespace tsar {

void Warn(const std::string& message) { LOG(WARNING) << Printable(message); }

std::string AndMore(const std::string& first, size_t count) {
  return count > 1 ? first + " and " + std::to_string(count - 1) + " more"
                   : first;
}

void PrepareWarnings(const char* program) {
  if (!google::IsGoogleLoggingInitialized()) {
    FLAGS_logtostderr = true;
    FLAGS_log_prefix = false;
    google::InitGoogleLogging(program);
  }
}

}  // namespace tsar
