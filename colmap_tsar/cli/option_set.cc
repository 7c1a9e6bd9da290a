// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/option_set.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/cli/name_suggestion.h"
#include "colmap_tsar/cli/short_help.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <utility>

#include <boost/program_options.hpp>

namespace tsar {
namespace {

namespace po = boost::program_options;

const char kProjectPath[] = "project_path";
const char kProjectPathHelp[] =
    "Ini file with values for these options: top-level keys, and one section "
    "per group. Options on the command line come before it.";

// The option's group, or an empty text for a top-level option.
std::string Group(const std::string& name) {
  const size_t dot = name.find('.');
  return dot == std::string::npos ? std::string() : name.substr(0, dot);
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
                            std::string* value,
                            const std::string& description) {
  options_.push_back({name, description, value, {}, {}, true});
}

void OptionSet::AddChoice(const std::string& name,
                          std::string* value,
                          const std::vector<std::string>& choices,
                          const std::string& description) {
  options_.push_back({name, description, value, {}, choices, false});
}

void OptionSet::AddFormerName(const std::string& former_name,
                              const std::string& name) {
  former_names_[former_name] = name;
}

bool OptionSet::Parse(int argc, const char* const* argv) const {
  std::map<std::string, std::string> written;
  for (const Option& option : options_) {
    written[option.name.substr(option.name.find('.') + 1)] = "--" + option.name;
  }
  SetOptionNamer([written](const std::string& key) {
    const auto found = written.find(key);
    return found == written.end() ? "--" + key : found->second;
  });
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
  std::set<std::string> names;
  for (const auto& [name, text] : given) {
    names.insert(name);
  }
  const auto project = given.find(kProjectPath);
  if (project != given.end()) {
    names.merge(ReadIni(project->second, names));
  }
  for (const auto& [name, text] : given) {
    if (name != kProjectPath) {
      Find(name)->Set(text, "--" + name);
    }
  }
  for (const Option& option : options_) {
    if (option.required &&
        (names.count(option.name) == 0 || option.Text().empty())) {
      throw Error(ErrorCode::kBadOption,
                  "--" + option.name + " is missing; give it as --" +
                      option.name + " " + option.ValueHint() + ", or see " +
                      command_ + " --help");
    }
  }
  return true;
}

CommandHelp OptionSet::Help() const {
  // Its value is read by Parse and not kept.
  static std::string no_project_path;
  CommandHelp help{command_, summary_, example_, options_};
  help.options.push_back(
      {kProjectPath, kProjectPathHelp, &no_project_path, {}, {}, false});
  return help;
}

std::map<std::string, std::string> OptionSet::Values() const {
  std::map<std::string, std::string> values;
  for (const Option& option : options_) {
    values[option.name] = option.Text();
  }
  return values;
}

const Option* OptionSet::Find(const std::string& name) const {
  const auto found =
      std::find_if(options_.begin(), options_.end(), [&](const Option& option) {
        return option.name == name;
      });
  return found == options_.end() ? nullptr : &*found;
}

// Warns where an option is written by a former name.
std::string OptionSet::PresentName(const std::string& written) const {
  const auto found = former_names_.find(written);
  if (found == former_names_.end()) {
    return written;
  }
  // Options may be parsed twice, for the values that a preset leaves to them.
  if (warned_names_.insert(written).second) {
    Warn(written + " is called " + found->second + " now");
  }
  return found->second;
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
  po::options_description description;
  for (const Option& option : options_) {
    description.add_options()(option.name.c_str(), po::value<std::string>());
  }
  for (const auto& [former_name, name] : former_names_) {
    description.add_options()(former_name.c_str(), po::value<std::string>());
  }
  description.add_options()(kProjectPath, po::value<std::string>());

  using Style = po::command_line_style::style_t;
  const int style =
      Style::allow_long | Style::long_allow_adjacent | Style::long_allow_next;
  po::parsed_options parsed(&description);
  try {
    parsed = po::command_line_parser(argc, argv)
                 .options(description)
                 .style(style)
                 .allow_unregistered()
                 .run();
  } catch (const po::error_with_option_name& error) {
    throw Error(ErrorCode::kBadOption,
                error.get_option_name() + " has no value; give one, or see " +
                    command_ + " --help");
  }

  std::map<std::string, std::string> values;
  for (const po::option& option : parsed.options) {
    const std::string& token = option.original_tokens.front();
    if (option.position_key >= 0 || option.string_key.empty()) {
      throw Error(ErrorCode::kBadOption,
                  "unexpected argument '" + token +
                      "'; options begin with two dashes, see " + command_ +
                      " --help");
    }
    if (option.unregistered) {
      const std::string name = token.substr(0, token.find('='));
      throw Error(ErrorCode::kBadOption,
                  "unknown option " + name + "; " +
                      Advice(name.substr(name.find_first_not_of('-'))));
    }
    const std::string name = "--" + option.string_key;
    // A value in a word of its own that looks like an option is one: the value
    // was forgotten.
    if (option.value.empty() || (option.original_tokens.size() > 1 &&
                                 option.value.front().starts_with("--"))) {
      throw Error(
          ErrorCode::kBadOption,
          name + " has no value; give one, or see " + command_ + " --help");
    }
    const std::string present = PresentName(option.string_key);
    if (!values.emplace(present, option.value.front()).second) {
      throw Error(ErrorCode::kBadOption,
                  "--" + present + " is given twice; give it once");
    }
  }
  return values;
}

std::set<std::string> OptionSet::ReadIni(
    const std::string& path, const std::set<std::string>& overridden) const {
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
  po::options_description description;
  po::parsed_options parsed(&description);
  try {
    parsed = po::parse_config_file(file, description, true);
  } catch (const po::error& error) {
    throw Error::File(ErrorCode::kCorrupt,
                      path,
                      std::string("not an ini file (") + error.what() + ")",
                      "write lines such as KEY = VALUE and [SECTION]");
  }

  std::set<std::string> groups;
  std::vector<std::string> top_level_names;
  for (const Option& option : options_) {
    const std::string group = Group(option.name);
    groups.insert(group);
    if (group.empty()) {
      top_level_names.push_back(option.name);
    }
  }
  std::set<std::string> names;
  for (const po::option& entry : parsed.options) {
    const std::string name = PresentName(entry.string_key);
    if (const Option* option = Find(name)) {
      if (!names.insert(name).second) {
        throw Error::File(ErrorCode::kBadOption,
                          path,
                          "key " + name + " is given twice",
                          "give it once");
      }
      if (overridden.count(name) == 0) {
        option->Set(entry.value.front(), path + ": " + name);
      }
      continue;
    }
    const std::string group = Group(name);
    const bool is_ours =
        group.empty() ? std::any_of(top_level_names.begin(),
                                    top_level_names.end(),
                                    [&](const std::string& known) {
                                      return EditDistance(name, known) <= 2;
                                    })
                      : groups.count(group) > 0;
    if (is_ours) {
      throw Error::File(
          ErrorCode::kBadOption, path, "unknown key " + name, Advice(name));
    }
  }
  return names;
}

}  // namespace tsar
