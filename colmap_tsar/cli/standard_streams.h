// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string_view>

namespace tsar {

// Opens closed standard streams (input, output, error) to nothing. Otherwise
// the first file that a program opens would get the number of a closed stream,
// and printed text would be written into it. To be called before any file is
// opened.
void OpenClosedStandardStreams();

// Writes all of these bytes unchanged to standard error, without memory or
// anything else that a program must set up first. Returns whether it succeeded.
bool WriteToStandardError(std::string_view bytes);

// From here on, all that this program and its libraries print to standard error
// passes through Printable(), line by line, since image decoders print content
// of their files. To be called once, by a program of its own; not where other
// code shares the process.
void KeepStandardErrorPrintable();

// Flushes standard output. Throws kIo where that fails, as on a full disk: a
// lost result must not look like success.
void FlushStandardOutput();

}  // namespace tsar
