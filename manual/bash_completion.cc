// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "manual/completion.h"

namespace tsar {
namespace {

// The function without what depends on the commands. In bash "=" is a word of
// its own.
constexpr const char* kHead = R"(
_colmap_tsar() {
  local word=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD-1]}
  local command=${COMP_WORDS[1]} position=2 words=
  if [[ $word == = ]]; then
    word=
  elif [[ $option == = ]]; then
    option=${COMP_WORDS[COMP_CWORD-2]}
  fi
  COMPREPLY=()
)";

constexpr const char* kTail =
    R"(  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -F _colmap_tsar colmap_tsar
)";

constexpr const char* kCompletePath =
    "      compopt -o filenames 2>/dev/null\n"
    "      mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n"
    "      return ;;\n";

std::string OptionWords(const FormDescription& form) {
  std::string words;
  for (const OptionDescription& option : form.options) {
    words += "--" + option.name + " ";
  }
  return words + "--help --help_json";
}

// Cases "COMMAND OPTION": what to write after the option.
std::string ValueCases(const std::string& command,
                       const FormDescription& form) {
  std::string paths;
  std::string others;
  std::string cases;
  for (const OptionDescription& option : form.options) {
    const std::string pattern = "\"" + command + " --" + option.name + "\"";
    if (!option.choices.empty()) {
      cases += "    " + pattern + ")\n      words=\"" +
               Join(option.choices, " ") + "\" ;;\n";
    } else {
      std::string& patterns = option.is_path ? paths : others;
      patterns += (patterns.empty() ? "    " : " | \\\n    ") + pattern;
    }
  }
  cases += paths.empty() ? "" : paths + ")\n" + kCompletePath;
  cases += others.empty() ? "" : others + ")\n      return ;;\n";
  return cases + "    \"" + command + " \"*)\n      words=\"" +
         OptionWords(form) + "\" ;;\n";
}

}  // namespace

std::string BashCompletion(const ProgramDescription& program) {
  std::string commands;
  std::string forms;
  std::string cases;
  for (const CommandDescription& command : program.commands) {
    commands += command.name + " ";
    std::string names;
    for (const FormDescription& form : command.forms) {
      const std::string space = form.name.empty() ? "" : " ";
      cases += ValueCases(command.name + space + form.name, form);
      names += form.name + space;
    }
    if (!names.empty()) {
      forms += "    " + command.name +
               ")\n      if ((COMP_CWORD == 2)); then\n        words=\"" +
               names +
               "--help --help_json\"\n      else\n        command+=\" "
               "${COMP_WORDS[2]}\"\n        position=3\n      fi ;;\n";
    }
  }
  std::string text = "# Completion of " + program.name + " for bash.\n";
  text += kHead;
  text += "  if ((COMP_CWORD == 1)); then\n    words=\"" + commands +
          "help --help --help_json --version\"\n  fi\n";
  if (!forms.empty()) {
    text += "  case $command in\n" + forms + "  esac\n";
  }
  return text + "  ((COMP_CWORD == position)) && option=\n" +
         "  [[ -z $words ]] && case \"$command $option\" in\n" + cases +
         "  esac\n" + kTail;
}

}  // namespace tsar
