// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/option_help.h"
#include "colmap_tsar/cli/option_value.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace tsar {

// The options of one command, in the manner of COLMAP's commands: top-level
// options ("--workspace_path DIR"), groups ("--TsarRefine.device cpu"), an ini
// file given by --project_path whose values the command line overrides, and
// --help, -h, which prints the most used of it, or --help_json.
//
// The ini file may be the project.ini of a COLMAP project: sections other than
// the groups of this command are ignored, and so are top-level keys that are
// not options of this command, unless they look like a misspelled one. An
// unknown key in a section of this command is an error.
class OptionSet {
 public:
  // The help begins with the summary (one paragraph) and shows the example, a
  // command line without the program's name.
  OptionSet(std::string command, std::string summary, std::string example);

  // Adds an option; the value that the target has now is the default. Names
  // must be unique; the target must outlive this object.
  void Add(const std::string& name,
           OptionTarget target,
           const std::string& description,
           const OptionRange& range = {});

  // Adds a file or folder that must be given and must not be empty.
  void AddRequired(const std::string& name,
                   std::filesystem::path* value,
                   const std::string& description);

  // Adds an option whose value must be one of the choices.
  void AddChoice(const std::string& name,
                 std::string* value,
                 const std::vector<std::string>& choices,
                 const std::string& description);

  // Adds an option whose value names settings: "name=value,name=value". The
  // value "help" prints them.
  void AddSettings(const std::string& name,
                   std::string* text,
                   std::vector<Option> settings,
                   const std::string& description);

  // Reads the arguments after argv[0], the program, into the targets. Returns
  // false, without touching any target, when help was asked for and has been
  // printed. Throws kBadOption for a wrong or missing option and kNotFound,
  // kCorrupt or kIo for an ini file that cannot be read; the message is one
  // line.
  bool Parse(int argc, const char* const* argv) const;

  // All options, in the order in which they were added.
  const std::vector<Option>& Options() const { return options_; }

  // The content of the help; PrintHelpJson prints it for programs.
  CommandHelp Help() const;

 private:
  // Has OptionName() name the options of this command as users write them.
  void NameOptions() const;
  const Option* Find(const std::string& name) const;
  std::string Advice(const std::string& written) const;
  std::map<std::string, std::string> ReadCommandLine(
      int argc, const char* const* argv) const;
  // Whether an unknown key of an ini file is meant for this command: in one of
  // its groups, or a top-level key that is spelled nearly like one of its own.
  bool SeemsOwn(const std::string& name) const;
  // Sets the options of the file but for the overridden ones, and returns the
  // names of all.
  std::set<std::string> ReadIni(const std::string& path,
                                const std::set<std::string>& overridden) const;

  std::string command_;
  std::string summary_;
  std::string example_;
  std::vector<Option> options_;
};

}  // namespace tsar
