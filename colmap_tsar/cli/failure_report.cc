// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/failure_report.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/cli/standard_streams.h"

#include <atomic>
#include <cstdlib>
#include <exception>
#include <string>

#include <unistd.h>

namespace tsar {
namespace {

// One line is enough for the user: failures while the program ends, such as
// when libraries clean up, follow from the reported one.
std::atomic_flag has_reported;

[[noreturn]] void EndProgram() {
  static std::atomic_flag is_ending;
  while (is_ending.test_and_set()) {
    pause();  // Another thread ends the program.
  }
  if (!has_reported.test()) {
    ReportFailure();
  }
  std::_Exit(EXIT_FAILURE);
}

}  // namespace

void ReportOutOfMemory() noexcept {
  WriteToStandardError("ERROR: ");
  WriteToStandardError(kOutOfMemory);
  WriteToStandardError("\n");
}

void ReportFailure() noexcept {
  has_reported.test_and_set();
  try {
    const std::exception_ptr failure = std::current_exception();
    // An exception that left a function that must not throw, such as a
    // destructor, is not accessible: little but memory can fail there.
    const std::string text = failure ? FailureText(failure)
                             : std::uncaught_exceptions() > 0
                                 ? kOutOfMemory
                                 : "unexpected failure";
    WriteToStandardError("ERROR: " + Printable(text) + "\n");
  } catch (...) {
    ReportOutOfMemory();
  }
}

void ReportUncaughtFailures() { std::set_terminate(&EndProgram); }

}  // namespace tsar
