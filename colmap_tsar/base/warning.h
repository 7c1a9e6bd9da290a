// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

namespace tsar {

// Logs one line for the user about something that is no error, as Printable()
// gives it. The one place that writes to the log; from any thread.
void Warn(const std::string& message);

// Has warnings go to standard error, without time or place. Called once, before
// the first; does nothing where the process uses glog already, as a program may
// that took over the commands. program: its
// name, which has to stay where it is.
void PrepareWarnings(const char* program);

}  // namespace tsar
