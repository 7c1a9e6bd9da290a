// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/warning.h"

#include "colmap_tsar/base/printable.h"

#include <glog/logging.h>

namespace tsar {

void Warn(const std::string& message) { LOG(WARNING) << Printable(message); }

void PrepareWarnings(const char* program) {
  if (!google::IsGoogleLoggingInitialized()) {
    FLAGS_logtostderr = true;
    FLAGS_log_prefix = false;
    google::InitGoogleLogging(program);
  }
}

}  // namespace tsar
