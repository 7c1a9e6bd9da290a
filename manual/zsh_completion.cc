// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include <ostream>
#include <sstream>

#include "manual/completion.h"

namespace tsar {
namespace {

// A text between single quotes, with a backslash before each of these letters.
std::string Quoted(const std::string& text, const std::string& special = "") {
  std::string quoted = "'";
  for (const char letter : text) {
    if (letter == '\'') {
      quoted += "'\\''";
      continue;
    }
    if (special.find(letter) != std::string::npos) {
      quoted += '\\';
    }
    quoted += letter;
  }
  return quoted + "'";
}

std::string Described(const std::string& name, const std::string& text) {
  return Quoted(name) + ":" + Quoted(text, ":\\");
}

// What _arguments takes for one option: with its value as the next word or
// after "=".
std::string Argument(const OptionDescription& option) {
  std::string value = "]:value:";
  if (!option.choices.empty()) {
    value.append("(").append(Join(option.choices, " ")).append(")");
  } else {
    value.append(option.is_path ? "_files" : " ");
  }
  return Quoted("--" + option.name + "=[") +
         Quoted(FirstSentence(option.description), "[]:\\") + Quoted(value);
}

void PrintArguments(const FormDescription& form,
                    const std::string& indentation,
                    std::ostream& out) {
  const std::string next = " \\\n" + indentation + "  ";
  out << indentation << "_arguments";
  for (const OptionDescription& option : form.options) {
    out << next << Argument(option);
  }
  out << next << "'(-h --help)'{-h,--help}'[Print the help]'" << next
      << "'--help_json[Print the help as JSON]' ;;\n";
}

void PrintForms(const CommandDescription& command, std::ostream& out) {
  out << "      if ((CURRENT == 2)); then\n        names=(\n";
  for (const FormDescription& form : command.forms) {
    out << "          " << Described(form.name, FirstSentence(form.summary))
        << "\n";
  }
  out << "          --help:'Print the help'\n"
         "          --help_json:'Print the help as JSON'\n        )\n"
         "        _describe -t forms form names\n        return\n      fi\n"
         "      shift words\n      ((CURRENT--))\n      case $words[1] in\n";
  for (const FormDescription& form : command.forms) {
    out << "        " << form.name << ")\n";
    PrintArguments(form, "          ", out);
  }
  out << "      esac ;;\n";
}

}  // namespace

std::string ZshCompletion(const ProgramDescription& program) {
  std::ostringstream out;
  out << "#compdef " << program.name << "\n# Completion of " << program.name
      << " for zsh.\n\n_colmap_tsar() {\n  local -a names\n"
         "  if ((CURRENT == 2)); then\n    names=(\n";
  for (const CommandDescription& command : program.commands) {
    out << "      " << Described(command.name, command.title) << "\n";
  }
  out << "      --help:'List the commands'\n"
         "      --help_json:'List the commands as JSON'\n"
         "      --version:'Print the version'\n    )\n"
         "    _describe -t commands command names\n    return\n  fi\n"
         "  shift words\n  ((CURRENT--))\n  case $words[1] in\n";
  for (const CommandDescription& command : program.commands) {
    out << "    " << command.name << ")\n";
    if (command.forms.size() == 1) {
      PrintArguments(command.forms[0], "      ", out);
    } else {
      PrintForms(command, out);
    }
  }
  out << "  esac\n}\n\n_colmap_tsar \"$@\"\n";
  return out.str();
}

}  // namespace tsar
