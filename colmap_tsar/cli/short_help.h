// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/option_help.h"

#include <ostream>
#include <string>

namespace tsar {

// Prints what one needs most of a command's help, on one screen of 24 lines of
// 80 letters: what it does, an example, the required options and those most
// used, and where the rest is. program: the name to show before the command.
void PrintShortHelp(const CommandHelp& help,
                    const std::string& program,
                    std::ostream& out);

}  // namespace tsar
