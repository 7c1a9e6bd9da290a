// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "manual/program_description.h"

namespace tsar {

// The manual pages of section 1 in troff's man macros: of the program, which
// lists the commands, and of one command with all its options.
std::string ProgramManPage(const ProgramDescription& program);
std::string CommandManPage(const ProgramDescription& program,
                           const CommandDescription& command);

// A text as troff prints it: with backslashes, hyphens that are to be copied
// and letters at the start of a line that would be commands to it.
std::string TroffText(const std::string& text);

}  // namespace tsar
