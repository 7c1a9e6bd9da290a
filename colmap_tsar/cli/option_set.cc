// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/option_set.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/parse_number.h"
#include "colmap_tsar/base/printable.h"

#include <algorithm>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <type_traits>
#include <utility>

#include <boost/algorithm/string/join.hpp>
#include <boost/program_options.hpp>
#include <nlohmann/json.hpp>

namespace tsar {
namespace {

namespace po = boost::program_options;

constexpr unsigned kLineLength = 100;

std::string RangeText(const OptionRange& range) {
  const bool has_min = range.min > OptionRange().min;
  const bool has_max = range.max < OptionRange().max;
  return has_min && has_max
             ? " from " + NumberText(range.min) + " to " + NumberText(range.max)
         : has_min ? " of at least " + NumberText(range.min)
         : has_max ? " of at most " + NumberText(range.max)
                   : "";
}

// "seed" of "TsarRefine.seed".
std::string KeyOf(const std::string& name) {
  return name.substr(name.find('.') + 1);
}

// "TsarRefine." of "TsarRefine.seed"; empty for a top-level option.
std::string GroupOf(const std::string& name) {
  return name.substr(0, name.find('.') + 1);
}

// " (did you mean --TsarRefine.device?)" where keys contain each other.
std::string Suggestion(const std::vector<Option>& options,
                       const std::string& written) {
  const std::string key = KeyOf(
      written.substr(std::min(written.find_first_not_of('-'), written.size())));
  std::vector<std::string> similar;
  for (const Option& option : options) {
    const std::string other = KeyOf(option.name);
    if (key.size() > 2 && (other.find(key) != std::string::npos ||
                           key.find(other) != std::string::npos)) {
      similar.push_back("--" + option.name);
    }
  }
  return similar.empty()
             ? ""
             : " (did you mean " + boost::join(similar, ", ") + "?)";
}

po::options_description Describe(const std::vector<Option>& options, bool all) {
  po::options_description described("Options", kLineLength, 60);
  for (const Option& option : options) {
    if (option.is_advanced && !all) {
      continue;
    }
    auto* value = po::value<std::string>()->value_name(option.ValueHint());
    if (const std::string text = option.Text(); !text.empty()) {
      value->default_value(text);
    }
    described.add_options()(
        option.name.c_str(), value, option.description.c_str());
  }
  return described;
}

// described: of the options; the result refers to it.
po::parsed_options ReadIni(const std::string& path,
                           const std::vector<Option>& options,
                           const po::options_description& described) {
  InputFile file(path);
  if (!file) {
    throw Error::File(ErrorCode::kNotFound,
                      path,
                      "cannot be read (" + file.Reason() + ")",
                      "give --project_path an ini file");
  }
  po::parsed_options parsed = po::parse_config_file(file, described, true);
  for (const po::option& item : parsed.options) {
    const std::string group = GroupOf(item.string_key);
    if (item.unregistered && !group.empty() &&
        std::ranges::any_of(options, [&](const Option& option) {
          return GroupOf(option.name) == group;
        })) {
      throw po::unknown_option(item.string_key);
    }
  }
  return parsed;
}

// What the command line gives, and an ini file for the rest.
struct GivenValues {
  po::variables_map values;
  std::set<std::string> on_command_line;
  std::string ini;  // Its path, or empty.
};

GivenValues ReadValues(const std::vector<Option>& options,
                       int argc,
                       const char* const* argv,
                       const std::string& advice) {
  using namespace po::command_line_style;  // NOLINT
  const po::options_description described = Describe(options, true);
  GivenValues given;
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::kBadOption,
                (given.ini.empty() ? "" : given.ini + ": ") + what + advice);
  };
  try {
    const po::parsed_options parsed =
        po::command_line_parser(argc, argv)
            .options(described)
            .style(allow_long | long_allow_adjacent | long_allow_next)
            .run();
    for (const po::option& item : parsed.options) {
      if (item.string_key.empty()) {
        fail("unexpected argument '" + item.value.at(0) +
             "', options begin with two dashes");
      }
      if (item.original_tokens.size() > 1 &&
          item.value.at(0).starts_with("--")) {
        fail("--" + item.string_key + " has no value");
      }
      given.on_command_line.insert(item.string_key);
    }
    po::store(parsed, given.values);
    if (given.on_command_line.contains("project_path")) {
      given.ini = given.values["project_path"].as<std::string>();
      po::store(ReadIni(given.ini, options, described), given.values);
    }
  } catch (const po::unknown_option& error) {
    const std::string written = error.get_option_name();
    const std::string name = written.substr(0, written.find('='));
    fail("unknown option " + name + Suggestion(options, name));
  } catch (const po::error& error) {
    fail(error.what());
  }
  return given;
}

// Has OptionName() name the options of this command as users write them.
void NameOptions(const std::vector<Option>& options) {
  std::map<std::string, std::string> written;
  for (const Option& option : options) {
    written[KeyOf(option.name)] = "--" + option.name;
  }
  SetOptionNamer([written](const std::string& key) {
    const auto found = written.find(key);
    return found == written.end() ? "--" + key : found->second;
  });
}

// Breaks a text into lines.
std::string Wrapped(const std::string& text) {
  std::istringstream words(text);
  std::string wrapped;
  size_t length = 0;
  for (std::string word; words >> word; length += word.size()) {
    const bool is_full = length + 1 + word.size() > kLineLength;
    wrapped += (wrapped.empty() ? "" : is_full ? "\n" : " ") + word;
    length = is_full ? 0 : length + 1;
  }
  return wrapped + "\n";
}

}  // namespace

void Option::Set(const std::string& text, const std::string& where) const {
  const auto require = [&](bool is_valid, const std::string& wanted) {
    if (!is_valid) {
      throw Error(ErrorCode::kBadOption,
                  where + ": '" + text + "' is not " + wanted);
    }
  };
  std::visit(
      [&](const auto& value) {
        using T = std::remove_pointer_t<std::decay_t<decltype(value)>>;
        require(choices.empty() || std::ranges::count(choices, text) > 0,
                "one of " + boost::join(choices, ", "));
        if constexpr (std::is_same_v<T, TextTarget>) {
          value.set(text);
        } else if constexpr (std::is_same_v<T, bool>) {
          const bool is_on = text == "1" || text == "true";
          require(is_on || text == "0" || text == "false", "0 or 1");
          *value = is_on;
        } else if constexpr (std::is_arithmetic_v<T>) {
          const std::optional<T> parsed = ParseNumber<T>(text);
          require(parsed && *parsed >= range.min && *parsed <= range.max,
                  (std::is_integral_v<T> ? "a whole number" : "a number") +
                      RangeText(range));
          *value = *parsed;
        } else {
          *value = text;
        }
      },
      target);
}

std::string Option::Text() const {
  return std::visit(
      [](const auto& value) -> std::string {
        using T = std::remove_pointer_t<std::decay_t<decltype(value)>>;
        if constexpr (std::is_same_v<T, TextTarget>) {
          return value.get();
        } else if constexpr (std::is_same_v<T, bool>) {
          return *value ? "1" : "0";
        } else if constexpr (std::is_arithmetic_v<T>) {
          return NumberText(*value);
        } else {
          return std::filesystem::path(*value).string();
        }
      },
      target);
}

std::string Option::ValueHint() const {
  constexpr const char* kHints[] = {
      "0|1", "INT", "NUMBER", "NUMBER", "TEXT", "TEXT", "PATH"};
  return choices.empty() ? kHints[target.index()] : boost::join(choices, "|");
}

OptionSet::OptionSet(std::string command,
                     std::string summary,
                     std::string example)
    : command_(std::move(command)),
      summary_(std::move(summary)),
      example_(std::move(example)) {}

Option& OptionSet::Add(const std::string& name,
                       OptionTarget target,
                       const std::string& description,
                       const OptionRange& range) {
  options_.push_back({name, target, description, range});
  return options_.back();
}

Option& OptionSet::AddRequired(const std::string& name,
                               std::filesystem::path* value,
                               const std::string& description) {
  Option& option = Add(name, value, description);
  option.is_required = true;
  return option;
}

bool OptionSet::Parse(int argc, const char* const* argv) {
  if (options_.back().name != "log_to_stderr") {  // Not at the second call.
    Add("project_path",
        &project_path_,
        "Ini file with values for these options: top-level keys, and a section "
        "per group. Options on the command line come before it.");
    const std::string taken =
        "Taken for the sake of COLMAP's commands, which have it; ";
    if (std::ranges::find(options_, "random_seed", &Option::name) ==
        options_.end()) {
      Add("random_seed", &unused_, taken + "nothing here is random.")
          .is_advanced = true;
    }
    Add("log_level", &unused_, taken + "there are no log levels.").is_advanced =
        true;
    Add("log_to_stderr",
        &log_to_stderr_,
        taken + "warnings go to standard error in any case.")
        .is_advanced = true;
  }
  NameOptions(options_);
  const std::set<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (words.contains("--help_json")) {
    PrintJson(std::cout);
    return false;
  }
  const bool all = words.contains("--help_all");
  if (all || words.contains("--help") || words.contains("-h")) {
    PrintHelp(std::filesystem::path(argv[0]).filename().string(), all);
    return false;
  }
  const std::string advice = "; see " + command_ + " --help";
  const GivenValues given = ReadValues(options_, argc, argv, advice);
  // Two options may have one target: the command line's comes last.
  for (const bool on_command_line : {false, true}) {
    for (const Option& option : options_) {
      const po::variable_value& value = given.values[option.name];
      if (!value.empty() && !value.defaulted() &&
          given.on_command_line.contains(option.name) == on_command_line) {
        option.Set(value.as<std::string>(),
                   on_command_line ? "--" + option.name
                                   : given.ini + ": " + option.name);
      }
    }
  }
  for (const Option& option : options_) {
    if (option.is_required && option.Text().empty()) {
      throw Error(ErrorCode::kBadOption,
                  "--" + option.name + " is missing; give it as --" +
                      option.name + " " + option.ValueHint() + advice);
    }
  }
  return true;
}

void OptionSet::PrintHelp(const std::string& program_name, bool all) const {
  const std::string program = Printable(program_name) + " ";
  std::cout << Wrapped(summary_) << "\nUsage:\n  " << program << command_;
  for (const Option& option : options_) {
    if (option.is_required) {
      std::cout << " --" << option.name << " " << option.ValueHint();
    }
  }
  std::cout << " [options]\n\nExample:\n  " << program << example_ << "\n\n"
            << Describe(options_, all) << "\n";
  const auto num_advanced =
      std::ranges::count(options_, true, &Option::is_advanced);
  if (!all) {
    std::cout << program << command_ << " --help_all lists " << num_advanced
              << " more options.\n";
  }
}

void OptionSet::PrintJson(std::ostream& out) const {
  nlohmann::ordered_json json = {{"command", command_},
                                 {"summary", summary_},
                                 {"example", example_},
                                 {"options", nlohmann::json::array()}};
  for (const Option& option : options_) {
    const bool is_switch = std::holds_alternative<bool*>(option.target);
    json["options"].push_back(
        {{"name", option.name},
         {"value", option.ValueHint()},
         {"choices",
          is_switch ? std::vector<std::string>{"0", "1"} : option.choices},
         {"is_path", option.ValueHint() == "PATH"},
         {"required", option.is_required},
         {"advanced", option.is_advanced},
         {"default", option.Text()},
         {"max", option.range.max},
         {"description", option.description}});
  }
  out << json.dump(2) << "\n";
}

}  // namespace tsar
