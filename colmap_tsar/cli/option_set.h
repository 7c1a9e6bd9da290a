// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace tsar {

// The range of values of a number, both ends included.
struct OptionRange {
  double min = std::numeric_limits<double>::lowest();
  double max = std::numeric_limits<double>::max();
};

// A variable of a type whose values have texts.
struct TextTarget {
  std::function<std::string()> get;
  std::function<void(const std::string&)> set;  // Throws kBadOption.
};

// The variable that an option sets.
using OptionTarget = std::variant<bool*,
                                  int*,
                                  float*,
                                  double*,
                                  std::string*,
                                  TextTarget,
                                  std::filesystem::path*>;

// One option of a command, from which the command line, ini files, the help,
// the manual and the keywords of the Python module are made.
struct Option {
  std::string name;         // Without dashes: "TsarRefine.seed".
  OptionTarget target;      // Holds the default.
  std::string description;  // A sentence or two; with the unit of the value.
  OptionRange range = {};   // Only for numbers.
  std::vector<std::string> choices = {};  // Only for texts; empty: any.
  bool is_required = false;
  bool is_advanced = false;  // Not in --help, but in --help_all.

  // Parses the text and writes the result to the target. Numbers must be finite
  // and take up the whole text; a bool is 0, 1, false or true. Throws
  // kBadOption with "WHERE: 'TEXT' is not ..." otherwise, and the target keeps
  // its value.
  void Set(const std::string& text, const std::string& where) const;

  // The target's present value as Set would read it. Numbers keep every bit.
  std::string Text() const;

  // The kind of value, for the help: INT, NUMBER, 0|1, PATH, TEXT or the
  // choices.
  std::string ValueHint() const;
};

// The options of one command, in the manner of COLMAP's commands: top-level
// options ("--workspace_path DIR"), groups ("--TsarRefine.device cpu"), an ini
// file given by --project_path whose values the command line overrides, and -h,
// --help, --help_all and --help_json.
//
// The ini file may be the project.ini of a COLMAP project: sections other than
// the groups of this command are ignored, and so are top-level keys that are
// not options of this command. An unknown key in a section of this command is
// an error.
class OptionSet {
 public:
  // The help begins with the summary (one paragraph) and shows the example, a
  // command line without the program's name.
  OptionSet(std::string command, std::string summary, std::string example);
  OptionSet(const OptionSet&) = delete;
  OptionSet& operator=(const OptionSet&) = delete;

  // Adds an option; the value that the target has now is the default. Names
  // must be unique; the target must outlive this object. Other members of the
  // option may be set in what is returned, until the next call.
  Option& Add(const std::string& name,
              OptionTarget target,
              const std::string& description,
              const OptionRange& range = {});

  // Adds a file or folder that must be given and must not be empty.
  Option& AddRequired(const std::string& name,
                      std::filesystem::path* value,
                      const std::string& description);

  // Adds an option whose value must be one of these, by the names that
  // ToString() gives them. Value: Enum, or an optional one.
  template <typename Enum, typename Value>
  Option& AddEnum(const std::string& name,
                  Value* value,
                  const std::vector<Enum>& values,
                  const std::string& description) {
    const auto get = [value] {
      const std::optional<Enum> now(*value);
      return now ? ToString(*now) : std::string();
    };
    const auto set = [value, values](const std::string& text) {
      *value = *std::ranges::find(
          values, text, [](Enum candidate) { return ToString(candidate); });
    };
    Option& option = Add(name, TextTarget{get, set}, description);
    for (const Enum candidate : values) {
      option.choices.push_back(ToString(candidate));
    }
    return option;
  }

  // Reads the arguments after argv[0], the program, into the targets. Returns
  // false, without touching any target, when help was asked for and has been
  // printed. Throws kBadOption for a wrong or missing option and kNotFound or
  // kCorrupt for an ini file that cannot be read; the message is one line.
  bool Parse(int argc, const char* const* argv);

  // Those of the command, in the order in which they were added.
  const std::vector<Option>& Options() const { return options_; }

  // Prints one JSON object: "command", "summary", "example" and "options", a
  // list in the order of the help. An option has "name" (without dashes),
  // "value" (what to give, as in the help), "choices" (a list, empty where any
  // value will do), "is_path", "required", "advanced", "default" (as text,
  // empty if there is none), "max" and "description".
  void PrintJson(std::ostream& out) const;

 private:
  void PrintHelp(const std::string& program, bool all) const;

  std::string command_;
  std::string summary_;
  std::string example_;
  std::filesystem::path project_path_;
  // Of options that have no effect.
  bool log_to_stderr_ = true;
  int unused_ = 0;
  std::vector<Option> options_;
};

}  // namespace tsar
