// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <string>

namespace tsar {

// Logs a warning for the user as one Printable() line. Only this function
// writes to the log; it is thread-safe.
void Warn(const std::string& message);

// "FIRST", or "FIRST and 2 more" of three.
std::string AndMore(const std::string& first, size_t count);

// Sends warnings to standard error, without time or location. Must be called
// once, before the first; does nothing if the process uses glog already, as a
// host program of the commands may. program: its name, which must stay valid.
void PrepareWarnings(const char* program);

}  // namespace tsar
