// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "manual/completion.h"

namespace tsar {
namespace {

std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char letter : text) {
    if (letter == '\'' || letter == '\\') {
      quoted += '\\';
    }
    quoted += letter;
  }
  return quoted + "'";
}

// Begins a rule that holds behind all of these words.
std::string Rule(const std::string& program,
                 const std::vector<std::string>& words) {
  std::string condition;
  for (const std::string& word : words) {
    condition += (condition.empty() ? "" : "; and ") +
                 ("__fish_seen_subcommand_from " + word);
  }
  return "complete -c " + program + " -n " + Quoted(condition);
}

std::string Value(const OptionDescription& option) {
  return option.is_path ? " -r -F"
         : option.choices.empty()
             ? " -x"
             : " -x -a " + Quoted(Join(option.choices, " "));
}

std::string HelpRules(const std::string& rule) {
  return rule + " -s h -l help -d 'Print the help'\n" + rule +
         " -l help_json -d 'Print the help as JSON'\n";
}

}  // namespace

std::string FishCompletion(const ProgramDescription& program) {
  const std::string start =
      "complete -c " + program.name + " -n __fish_use_subcommand";
  std::string text = "# Completion of " + program.name +
                     " for fish.\n\ncomplete -c " + program.name + " -f\n" +
                     HelpRules(start) + start +
                     " -l version -d 'Print the version'\n";
  for (const CommandDescription& command : program.commands) {
    text += "\n" + start + " -a " + command.name + " -d " +
            Quoted(command.title) + "\n";
    std::vector<std::string> names;
    for (const FormDescription& form : command.forms) {
      names.push_back(form.name);
    }
    const std::string all_names = Join(names, " ");
    for (const FormDescription& form : command.forms) {
      std::vector<std::string> words = {command.name};
      if (!form.name.empty()) {
        text += "complete -c " + program.name + " -n " +
                Quoted("__fish_seen_subcommand_from " + command.name +
                       "; and not __fish_seen_subcommand_from " + all_names) +
                " -a " + form.name + " -d " +
                Quoted(FirstSentence(form.summary)) + "\n";
        words.push_back(form.name);
      }
      const std::string rule = Rule(program.name, words);
      for (const OptionDescription& option : form.options) {
        text += rule + " -l " + option.name + Value(option) + " -d " +
                Quoted(FirstSentence(option.description)) + "\n";
      }
      text += HelpRules(rule);
    }
  }
  return text;
}

}  // namespace tsar
