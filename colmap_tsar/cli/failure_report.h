// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace tsar {

// Prints the exception that is being handled as one line "ERROR: ..." to
// standard error, also where no memory is left.
void ReportFailure() noexcept;

// Prints that memory ran out. Allocates none, and needs nothing that is set up
// when a program starts.
void ReportOutOfMemory() noexcept;

// Makes the program end with such a line and exit code 1, also for an exception
// that nothing can catch: one that leaves a destructor or a static object's
// constructor. No file is half written then, as after a kill.
void ReportUncaughtFailures();

}  // namespace tsar
