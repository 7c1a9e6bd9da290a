// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/option_set.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/cli/name_suggestion.h"

#include <algorithm>
#include <iostream>
#include <utility>

namespace tsar {
namespace {

const char kProjectPath[] = "project_path";
const char kProjectPathHelp[] =
    "Ini file with values for these options: top-level keys, and one section "
    "per group. Options on the command line come before it.";

// An option of COLMAP's commands, accepted for users who call all commands with
// the same options.
const char kLogToStderr[] = "log_to_stderr";
const char kLogToStderrHelp[] =
    "Taken for the sake of COLMAP's commands, which have it; warnings go to "
    "standard error in any case.";

// The option's group, or an empty text for a top-level option.
std::string Group(const std::string& name) {
  const size_t dot = name.find('.');
  return dot == std::string::npos ? std::string() : name.substr(0, dot);
}

std::string Trim(const std::string& text) {
  const char kSpaces[] = " \t\r\v\f";
  const size_t begin = text.find_first_not_of(kSpaces);
  return begin == std::string::npos
             ? std::string()
             : text.substr(begin, text.find_last_not_of(kSpaces) + 1 - begin);
}

// Calls function(name, value) for each KEY = VALUE of an ini file, in order;
// name: SECTION.KEY, or KEY before the first section.
template <typename Function>
void ForEachIniValue(const std::string& path, const Function& function) {
  InputFile file(path);
  if (file.IsMissing() || file.IsNoFile()) {
    throw Error::File(ErrorCode::kNotFound,
                      path,
                      "there is no such file",
                      "give --project_path an ini file");
  }
  if (!file) {
    throw Error::File(ErrorCode::kIo,
                      path,
                      "the file cannot be opened (" + file.Reason() + ")",
                      "check that it is a file and that you may read it");
  }
  std::string prefix;
  int line_number = 0;
  for (std::string line; std::getline(file, line);) {
    ++line_number;
    line = Trim(line.substr(0, line.find('#')));
    if (line.empty()) {
      continue;
    }
    if (line.front() == '[' && line.back() == ']') {
      prefix = line.substr(1, line.size() - 2) + ".";
      continue;
    }
    const size_t equals = line.find('=');
    if (equals == std::string::npos) {
      throw Error::File(
          ErrorCode::kCorrupt,
          path,
          "not an ini file (line " + std::to_string(line_number) + ")",
          "write lines such as KEY = VALUE and [SECTION]");
    }
    function(prefix + Trim(line.substr(0, equals)),
             Trim(line.substr(equals + 1)));
  }
}

bool HasArgument(int argc, const char* const* argv, const std::string& name) {
  return std::any_of(argv + std::min(argc, 1), argv + argc, [&](const char* a) {
    return a == name;
  });
}

}  // namespace

OptionSet::OptionSet(std::string command,
                     std::string summary,
                     std::string example)
    : command_(std::move(command)),
      summary_(std::move(summary)),
      example_(std::move(example)) {}

void OptionSet::Add(const std::string& name,
                    OptionTarget target,
                    const std::string& description,
                    const OptionRange& range) {
  options_.push_back({name, description, target, range, {}, false});
}

void OptionSet::AddRequired(const std::string& name,
                            std::filesystem::path* value,
                            const std::string& description) {
  options_.push_back({name, description, value, {}, {}, true});
}

void OptionSet::AddChoice(const std::string& name,
                          std::string* value,
                          const std::vector<std::string>& choices,
                          const std::string& description) {
  options_.push_back({name, description, value, {}, choices, false});
}

void OptionSet::AddSettings(const std::string& name,
                            std::string* text,
                            std::vector<Option> settings,
                            const std::string& description) {
  options_.push_back(
      {name, description, text, {}, {}, false, std::move(settings)});
}

bool OptionSet::Parse(int argc, const char* const* argv) const {
  NameOptions();
  if (HasArgument(argc, argv, "--help_json")) {
    PrintHelpJson(Help(), std::cout);
    return false;
  }
  const bool is_long = HasArgument(argc, argv, "--help");
  if (is_long || HasArgument(argc, argv, "-h")) {
    (is_long ? PrintHelp : PrintShortHelp)(
        Help(), std::filesystem::path(argv[0]).filename().string(), std::cout);
    return false;
  }
  const std::map<std::string, std::string> given = ReadCommandLine(argc, argv);
  for (const Option& option : options_) {
    const auto found = given.find(option.name);
    if (!option.settings.empty() && found != given.end() &&
        found->second == "help") {
      PrintSettings(option, std::cout);
      return false;
    }
  }
  std::set<std::string> names;
  for (const auto& [name, text] : given) {
    names.insert(name);
  }
  const auto project = given.find(kProjectPath);
  if (project != given.end()) {
    names.merge(ReadIni(project->second, names));
  }
  for (const auto& [name, text] : given) {
    if (name != kProjectPath && name != kLogToStderr) {
      Find(name)->Set(text, "--" + name);
    }
  }
  for (const Option& option : options_) {
    if (option.required &&
        (!names.contains(option.name) || option.Text().empty())) {
      throw Error(ErrorCode::kBadOption,
                  "--" + option.name + " is missing; give it as --" +
                      option.name + " " + option.ValueHint() + ", or see " +
                      command_ + " --help");
    }
  }
  return true;
}

void OptionSet::NameOptions() const {
  std::map<std::string, std::string> written;
  for (const Option& option : options_) {
    written[option.name.substr(option.name.find('.') + 1)] = "--" + option.name;
    for (const Option& setting : option.settings) {
      written[setting.name] = "--" + option.name + " " + setting.name;
    }
  }
  SetOptionNamer([written](const std::string& key) {
    const auto found = written.find(key);
    return found == written.end() ? "--" + key : found->second;
  });
}

CommandHelp OptionSet::Help() const {
  // Parse reads its value and does not keep it.
  static std::filesystem::path no_project_path;
  CommandHelp help{command_, summary_, example_, options_};
  help.options.push_back(
      {kProjectPath, kProjectPathHelp, &no_project_path, {}, {}, false});
  static bool logs_to_stderr = true;
  help.options.push_back(
      {kLogToStderr, kLogToStderrHelp, &logs_to_stderr, {}, {}, false});
  return help;
}

const Option* OptionSet::Find(const std::string& name) const {
  const auto found =
      std::find_if(options_.begin(), options_.end(), [&](const Option& option) {
        return option.name == name;
      });
  return found == options_.end() ? nullptr : &*found;
}

std::string OptionSet::Advice(const std::string& written) const {
  std::vector<std::string> names = {kProjectPath, "help", "help_json"};
  for (const Option& option : options_) {
    names.push_back(option.name);
  }
  std::string advice;
  for (const std::string& name : SuggestNames(written, names)) {
    advice += (advice.empty() ? "did you mean --" : " or --") + name;
  }
  return (advice.empty() ? "see " : advice + "? See ") + command_ + " --help";
}

std::map<std::string, std::string> OptionSet::ReadCommandLine(
    int argc, const char* const* argv) const {
  std::map<std::string, std::string> values;
  for (int i = 1; i < argc; ++i) {
    const std::string token = argv[i];
    const size_t equals = token.find('=');
    const std::string written = token.substr(0, equals);
    if (!token.starts_with("--") || written.size() == 2) {
      throw Error(ErrorCode::kBadOption,
                  "unexpected argument '" + token +
                      "'; options begin with two dashes, see " + command_ +
                      " --help");
    }
    const std::string name = written.substr(2);
    if (name != kProjectPath && name != kLogToStderr && Find(name) == nullptr) {
      throw Error(ErrorCode::kBadOption,
                  "unknown option " + written + "; " + Advice(name));
    }
    // A value in a word of its own that looks like an option is one: the value
    // was forgotten.
    const bool has_value =
        equals == std::string::npos
            ? i + 1 < argc && !std::string(argv[i + 1]).starts_with("--")
            : equals + 1 < token.size();
    if (!has_value) {
      throw Error(
          ErrorCode::kBadOption,
          written + " has no value; give one, or see " + command_ + " --help");
    }
    const std::string value =
        equals == std::string::npos ? argv[++i] : token.substr(equals + 1);
    if (!values.emplace(name, value).second) {
      throw Error(ErrorCode::kBadOption,
                  written + " is given twice; give it once");
    }
  }
  return values;
}

bool OptionSet::SeemsOwn(const std::string& name) const {
  const std::string group = Group(name);
  return std::ranges::any_of(options_, [&](const Option& option) {
    return Group(option.name) == group &&
           (!group.empty() || EditDistance(name, option.name) <= 2);
  });
}

std::set<std::string> OptionSet::ReadIni(
    const std::string& path, const std::set<std::string>& overridden) const {
  std::set<std::string> names;
  ForEachIniValue(path, [&](const std::string& name, const std::string& value) {
    const Option* option = Find(name);
    if (option == nullptr) {
      if (SeemsOwn(name)) {
        throw Error::File(
            ErrorCode::kBadOption, path, "unknown key " + name, Advice(name));
      }
      return;
    }
    if (!names.insert(name).second) {
      throw Error::File(ErrorCode::kBadOption,
                        path,
                        "key " + name + " is given twice",
                        "give it once");
    }
    if (!overridden.contains(name)) {
      option->Set(value, path + ": " + name);
    }
  });
  return names;
}

}  // namespace tsar
