// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace tsar {

// The values that a number may take; both ends belong to it.
struct OptionRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

// The variable that an option sets.
using OptionTarget = std::variant<bool*,
                                  int*,
                                  int64_t*,
                                  float*,
                                  double*,
                                  std::string*,
                                  std::filesystem::path*>;

// One option of a command: where its value goes and what it may be.
struct Option {
  std::string name;         // Without dashes: "TsarRefine.num_iterations".
  std::string description;  // A sentence; with the unit of the value.
  OptionTarget target;
  OptionRange range = {};  // Only for numbers.
  // Only for strings; empty: any text.
  std::vector<std::string> choices = {};
  bool required = false;
  // The possible names in a text of the form "name=value,name=value".
  std::vector<Option> settings = {};
  // By preset name, as text: the value in the preset, if not the default.
  std::map<std::string, std::string> presets = {};

  // Parses the text and writes the result to the target, and to those of the
  // settings that it names. Numbers must be finite and take up the whole text;
  // a bool is 0, 1, false or true. Throws kBadOption with "WHERE: WHAT IS
  // WRONG" otherwise, and the target keeps its value.
  void Set(const std::string& text, const std::string& where) const;

  // The target's present value as Set would read it. Numbers keep every bit.
  std::string Text() const;

  // Whether the value is a file or a folder.
  bool IsPath() const;

  // The kind of value, for the help: INT, NUMBER, 0|1, PATH, TEXT,
  // NAME=VALUE,... or the choices.
  std::string ValueHint() const;
};

}  // namespace tsar
