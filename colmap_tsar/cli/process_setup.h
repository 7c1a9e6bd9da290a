// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Setup at the start of a program, so that it ends cleanly with a message even
// without standard streams or memory.

namespace tsar {

// Opens closed standard streams (input, output, error) to nothing. Otherwise
// the first file that a program opens would get the number of a closed stream,
// and printed text would be written into it. To be called before any file is
// opened.
void OpenClosedStandardStreams();

// From here on, all that this program and its libraries print to standard error
// passes through Printable(), line by line, since image decoders print content
// of their files. To be called once, by a program of its own; not where other
// code shares the process.
void KeepStandardErrorPrintable();

// Flushes standard output. Throws kIo where that fails, as on a full disk: a
// lost result must not look like success.
void FlushStandardOutput();

// Prints the exception that is being handled as one line "ERROR: ..." to
// standard error, also where no memory is left.
void ReportFailure() noexcept;

// Prints that memory ran out. Allocates none, and needs no static
// initialization.
void ReportOutOfMemory() noexcept;

// Makes the program end with such a line and exit code 1, also for an exception
// that nothing can catch: one that leaves a destructor or a static object's
// constructor. No file is half written then, as after a kill.
void ReportUncaughtFailures();

// Whether there is memory for the initialization of libraries when a program
// starts. Without it, some end the program or write to invalid addresses.
// Allocates none itself, and may be called before they are initialized.
bool HasMemoryToStart();

// Forces the lazy initialization of libraries that must not fail later, so that
// memory can run out later without harm. Throws std::bad_alloc where there is
// not enough to begin with.
void PrepareForLowMemory();

}  // namespace tsar
