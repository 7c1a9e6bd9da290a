// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/option_help.h"

#include "colmap_tsar/base/printable.h"

#include <ostream>
#include <sstream>
#include <variant>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

std::vector<std::string> Choices(const Option& option) {
  return std::holds_alternative<bool*>(option.target)
             ? std::vector<std::string>{"0", "1"}
             : option.choices;
}

}  // namespace

std::string WrapText(const std::string& text, size_t indentation) {
  const std::string indent(indentation, ' ');
  std::istringstream words(text);
  std::string wrapped;
  std::string line = indent;
  for (std::string word; words >> word;) {
    if (line.size() > indentation && line.size() + 1 + word.size() > 79) {
      wrapped += line + "\n";
      line = indent;
    }
    line += (line.size() > indentation ? " " : "") + word;
  }
  return wrapped + line + "\n";
}

void PrintHelp(const CommandHelp& help,
               const std::string& program_name,
               std::ostream& out) {
  const std::string program = Printable(program_name);
  std::string usage = program + " " + help.command;
  for (const Option& option : help.options) {
    if (option.required) {
      usage += " --" + option.name + " " + option.ValueHint();
    }
  }
  out << WrapText(help.summary, 0) << "\nUsage:\n  " << usage
      << " [options]\n\nExample:\n  " << program << " " << help.example
      << "\n\nOptions:\n";
  for (const Option& option : help.options) {
    const std::string text = option.Text();
    out << "  --" << option.name << " " << option.ValueHint()
        << (option.required ? " (required)"
            : text.empty()  ? ""
                            : " (default: " + text + ")")
        << "\n"
        << WrapText(option.description, 6);
  }
  out << "  -h, --help\n      Print this text; -h what is used most of it.\n"
      << "  --help_json\n      Print the same as JSON, for programs.\n";
}

void PrintHelpJson(const CommandHelp& help, std::ostream& out) {
  nlohmann::ordered_json json;
  json["command"] = help.command;
  json["summary"] = help.summary;
  json["example"] = help.example;
  json["options"] = nlohmann::ordered_json::array();
  for (const Option& option : help.options) {
    json["options"].push_back({{"name", option.name},
                               {"value", option.ValueHint()},
                               {"choices", Choices(option)},
                               {"is_path", option.IsPath()},
                               {"required", option.required},
                               {"default", option.Text()},
                               {"description", option.description}});
  }
  out << json.dump(2) << "\n";
}

}  // namespace tsar
