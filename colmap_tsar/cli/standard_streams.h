// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string_view>

namespace tsar {

// Opens those of standard input, output and error that are closed, to nothing.
// The first file that a program opens would get the number of a closed stream
// otherwise, and what is printed would be written into it. To be called before
// any file is opened.
void OpenClosedStandardStreams();

// Writes all of these bytes to standard error as they are, without memory or
// anything else that a program must set up first. Whether that was possible.
bool WriteToStandardError(std::string_view bytes);

// From here on, what this program and its libraries print to standard error
// passes through Printable(), line by line: the readers of pictures print what
// stands in these. Once, for a program of its own; not where other code shares
// the process.
void KeepStandardErrorPrintable();

// Writes what has been printed to standard output. Throws kIo where that cannot
// be, such as on a full disk: a result that is lost must not look like one.
void FlushStandardOutput();

}  // namespace tsar
