// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/option_value.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace tsar {

// The content of the help of one command.
struct CommandHelp {
  std::string command;          // "tsar_refine".
  std::string summary;          // One paragraph.
  std::string example;          // A command line without the program's name.
  std::vector<Option> options;  // All but --help itself.
};

// Prints the help for people, in lines of at most 79 letters. program: the
// name to show before the command.
void PrintHelp(const CommandHelp& help,
               const std::string& program,
               std::ostream& out);

// Prints the most important part of the help, on one screen of 24 lines of 80
// letters: the summary, an example, the required and most used options, and
// where to find the rest.
void PrintShortHelp(const CommandHelp& help,
                    const std::string& program,
                    std::ostream& out);

// Prints the names that the value of an option of settings may contain.
void PrintSettings(const Option& option, std::ostream& out);

// Prints the help as one JSON object, for programs: "command", "summary",
// "example" and "options", a list in the order of the help. An option has
// "name" (without dashes), "value" (what to give, as in the help), "choices"
// (a list, empty where any value will do), "is_path" (the value is a file or a
// folder), "required", "default" (as text, empty if there is none) and
// "description". One of settings has these as "settings", a list of the same
// form, with "presets" beside, an object of the values that differ there.
void PrintHelpJson(const CommandHelp& help, std::ostream& out);

}  // namespace tsar
