// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "manual/program_description.h"

#include "colmap_tsar/cli/commands.h"

#include <iostream>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

using Json = nlohmann::json;

constexpr const char* kProgram = "colmap_tsar";

// Sends std::cout to a text while it lives.
class CapturedOutput {
 public:
  CapturedOutput() : former_(std::cout.rdbuf(text_.rdbuf())) {}
  ~CapturedOutput() { std::cout.rdbuf(former_); }
  CapturedOutput(const CapturedOutput&) = delete;
  CapturedOutput& operator=(const CapturedOutput&) = delete;

  std::string Text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::streambuf* former_;
};

// What the program prints for these words and --help_json.
Json Ask(std::vector<std::string> words) {
  words.insert(words.begin(), kProgram);
  words.push_back("--help_json");
  std::vector<char*> argv;
  std::string line;
  for (std::string& word : words) {
    argv.push_back(word.data());
    line += (line.empty() ? "" : " ") + word;
  }
  const CapturedOutput output;
  const int code = RunProgram(static_cast<int>(argv.size()), argv.data());
  if (code != 0) {
    throw std::runtime_error(line + ": exit code " + std::to_string(code));
  }
  try {
    return Json::parse(output.Text());
  } catch (const Json::parse_error&) {
    throw std::runtime_error(line + ": printed no JSON");
  }
}

FormDescription ToForm(const std::string& name, const Json& json) {
  FormDescription form{name, json.at("summary"), json.at("example"), {}};
  for (const Json& option : json.at("options")) {
    form.options.push_back({option.at("name"),
                            option.at("value"),
                            option.at("choices"),
                            option.at("is_path"),
                            option.at("required"),
                            option.at("default"),
                            option.at("description")});
  }
  return form;
}

CommandDescription DescribeCommand(const std::string& name,
                                   const std::string& title) {
  const Json json = Ask({name});
  CommandDescription command{name, title, json.at("summary"), {}};
  if (!json.contains("forms")) {
    command.forms.push_back(ToForm("", json));
    return command;
  }
  for (const Json& form : json.at("forms")) {
    const std::string form_name = form.at("name");
    command.forms.push_back(ToForm(form_name, Ask({name, form_name})));
  }
  return command;
}

}  // namespace

ProgramDescription DescribeProgram() {
  const Json json = Ask({});
  ProgramDescription program{
      kProgram, json.at("summary"), json.at("version"), {}};
  for (const Json& command : json.at("commands")) {
    program.commands.push_back(
        DescribeCommand(command.at("name"), command.at("summary")));
  }
  return program;
}

}  // namespace tsar
