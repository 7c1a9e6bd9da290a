// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/cli/commands.h"
#include "colmap_tsar/cli/process_setup.h"

#include <cstdlib>

namespace {

// Runs before the libraries initialize, which open files and take memory.
void PrepareStart() {
  tsar::OpenClosedStandardStreams();
  tsar::ReportUncaughtFailures();
  if (!tsar::HasMemoryToStart()) {
    tsar::ReportOutOfMemory();
    std::_Exit(EXIT_FAILURE);
  }
}

// The system calls the functions in this section first of all.
[[gnu::section(".preinit_array"),
  gnu::used]] void (*const prepare_start)() = &PrepareStart;

}  // namespace

int main(int argc, char** argv) {
  tsar::KeepStandardErrorPrintable();
  tsar::PrepareWarnings(argv[0]);
  return tsar::RunProgram(argc, argv);
}
