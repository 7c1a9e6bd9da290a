// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/commands.h"

#include <glog/logging.h>

int main(int argc, char** argv) {
  FLAGS_logtostderr = true;
  FLAGS_log_prefix = false;
  google::InitGoogleLogging(argv[0]);
  return tsar::RunProgram(argc, argv);
}
