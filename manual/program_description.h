// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

namespace tsar {

struct OptionDescription {
  std::string name;   // Without dashes.
  std::string value;  // What to give: "PATH", "INT", "auto|cuda|cpu".
  std::vector<std::string> choices;  // Empty: any value.
  bool is_path = false;
  bool required = false;
  std::string default_value;
  std::string description;  // Sentences.
};

// One way to call a command: most commands have one, without a name.
struct FormDescription {
  std::string name;     // "depth" in "tsar_evaluate depth", or empty.
  std::string summary;  // A paragraph.
  std::string example;  // Without the program's name; empty if there is none.
  std::vector<OptionDescription> options;
};

struct CommandDescription {
  std::string name;
  std::string title;  // One line.
  std::string summary;
  std::vector<FormDescription> forms;
};

struct ProgramDescription {
  std::string name;
  std::string summary;
  std::string version;
  std::vector<CommandDescription> commands;
};

// The program colmap_tsar with all commands and options: what --help_json tells
// of each. Throws std::runtime_error for a command that does not know it.
ProgramDescription DescribeProgram();

}  // namespace tsar
