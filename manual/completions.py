# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Scripts by which a shell completes the program's commands, their options, the
choices of an option, and files and folders."""
import re

# The function without what depends on the commands. In bash "=" is a word of
# its own.
BASH = r"""# Completion of {name} for bash.

_colmap_tsar() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} option=${{COMP_WORDS[COMP_CWORD-1]}}
  local command=${{COMP_WORDS[1]}} position=2 words=
  if [[ $word == = ]]; then
    word=
  elif [[ $option == = ]]; then
    option=${{COMP_WORDS[COMP_CWORD-2]}}
  fi
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    words="{commands} help --help --help_json --version"
  fi
  case $command in
{forms}  esac
  ((COMP_CWORD == position)) && option=
  [[ -z $words ]] && case "$command $option" in
{cases}  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}}
complete -F _colmap_tsar colmap_tsar
"""

BASH_FORMS = """\
    {command})
      if ((COMP_CWORD == 2)); then
        words="{forms} --help --help_json"
      else
        command+=" ${{COMP_WORDS[2]}}"
        position=3
      fi ;;
"""

BASH_PATHS = """\
{patterns})
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -- "$word")
      return ;;
"""

ZSH = """\
#compdef {name}
# Completion of {name} for zsh.

_colmap_tsar() {{
  local -a names
  if ((CURRENT == 2)); then
    names=(
{commands}      --help:'List the commands'
      --help_json:'List the commands as JSON'
      --version:'Print the version'
    )
    _describe -t commands command names
    return
  fi
  shift words
  ((CURRENT--))
  case $words[1] in
{cases}  esac
}}

_colmap_tsar "$@"
"""

ZSH_FORMS = """\
      if ((CURRENT == 2)); then
        names=(
{forms}          --help:'Print the help'
          --help_json:'Print the help as JSON'
        )
        _describe -t forms form names
        return
      fi
      shift words
      ((CURRENT--))
      case $words[1] in
{cases}      esac ;;
"""


def first_sentence(text):
    """Without its full stop."""
    head, separator, _ = text.partition(". ")
    return head if separator else re.sub(r"\.$", "", text)


def names(items):
    return " ".join(item["name"] for item in items)


def call(command, form):
    """The words by which a form of a command is called."""
    return " ".join(filter(None, (command["name"], form["name"])))


def bash_cases(command, form):
    """Cases "COMMAND OPTION": what to write after the option."""
    words = call(command, form)
    pattern = {option["name"]: f'    "{words} --{option["name"]}"' for option in form["options"]}
    free = [option for option in form["options"] if not option["choices"]]
    paths = " | \\\n".join(pattern[option["name"]] for option in free if option["is_path"])
    others = " | \\\n".join(pattern[option["name"]] for option in free if not option["is_path"])
    text = ""
    for option in form["options"]:
        if option["choices"]:
            text += f'{pattern[option["name"]]})\n      words="{" ".join(option["choices"])}" ;;\n'
    if paths:
        text += BASH_PATHS.format(patterns=paths)
    if others:
        text += f"{others})\n      return ;;\n"
    known = "".join(f"--{option['name']} " for option in form["options"])
    return text + f'    "{words} "*)\n      words="{known}--help --help_all --help_json" ;;\n'


def bash_completion(program):
    commands = program["commands"]
    return BASH.format(
        name=program["name"],
        commands=names(commands),
        forms="".join(
            BASH_FORMS.format(command=command["name"], forms=names(command["forms"]))
            for command in commands
            if len(command["forms"]) > 1
        ),
        cases="".join(
            bash_cases(command, form) for command in commands for form in command["forms"]
        ),
    )


def zsh_quoted(text, special=""):
    """A text between single quotes, with a backslash before these letters."""
    text = "".join("\\" + letter if letter in special else letter for letter in text)
    return "'" + text.replace("'", "'\\''") + "'"


def zsh_described(name, text):
    return f"{zsh_quoted(name)}:{zsh_quoted(text, special=':' + chr(92))}\n"


def zsh_arguments(form, indentation):
    """What _arguments takes for each option: its value is the next word or
    stands after "="."""
    lines = [indentation + "_arguments"]
    for option in form["options"]:
        value = "_files" if option["is_path"] else " "
        if option["choices"]:
            value = f"({' '.join(option['choices'])})"
        lines.append(
            zsh_quoted(f"--{option['name']}=[")
            + zsh_quoted(first_sentence(option["description"]), special="[]:\\")
            + zsh_quoted(f"]:value:{value}")
        )
    lines.append("'(-h --help)'{-h,--help}'[Print the help]'")
    lines.append("'--help_all[Print the help with all options]'")
    lines.append("'--help_json[Print the help as JSON]' ;;\n")
    return f" \\\n{indentation}  ".join(lines)


def zsh_case(command):
    forms = command["forms"]
    text = f"    {command['name']})\n"
    if len(forms) == 1:
        return text + zsh_arguments(forms[0], " " * 6)
    return text + ZSH_FORMS.format(
        forms="".join(
            " " * 10 + zsh_described(form["name"], first_sentence(form["summary"])) for form in forms
        ),
        cases="".join(
            f"        {form['name']})\n" + zsh_arguments(form, " " * 10) for form in forms
        ),
    )


def zsh_completion(program):
    commands = program["commands"]
    return ZSH.format(
        name=program["name"],
        commands="".join(
            " " * 6 + zsh_described(command["name"], command["title"]) for command in commands
        ),
        cases="".join(map(zsh_case, commands)),
    )


def fish_quoted(text):
    return "'" + re.sub(r"(['\\])", r"\\\1", text) + "'"


def fish_help(rule):
    return (
        f"{rule} -s h -l help -d 'Print the help'\n"
        f"{rule} -l help_json -d 'Print the help as JSON'\n"
    )


def fish_option(rule, option):
    value = "-r -F" if option["is_path"] else "-x"
    if option["choices"]:
        value = f"-x -a {fish_quoted(' '.join(option['choices']))}"
    description = fish_quoted(first_sentence(option["description"]))
    return f"{rule} -l {option['name']} {value} -d {description}\n"


def fish_form(start, command, form):
    """The form's name after the command's, where it has one, and the rules that
    hold behind both."""
    text = ""
    seen = f"__fish_seen_subcommand_from {command['name']}"
    if form["name"]:
        condition = f"{seen}; and not __fish_seen_subcommand_from {names(command['forms'])}"
        summary = fish_quoted(first_sentence(form["summary"]))
        text = f"{start} -n {fish_quoted(condition)} -a {form['name']} -d {summary}\n"
        seen += f"; and __fish_seen_subcommand_from {form['name']}"
    rule = f"{start} -n {fish_quoted(seen)}"
    options = "".join(fish_option(rule, option) for option in form["options"])
    help_all = f"{rule} -l help_all -d 'Print the help with all options'\n"
    return text + options + fish_help(rule) + help_all


def fish_completion(program):
    start = f"complete -c {program['name']}"
    first = f"{start} -n __fish_use_subcommand"
    text = f"# Completion of {program['name']} for fish.\n\n{start} -f\n"
    text += fish_help(first) + f"{first} -l version -d 'Print the version'\n"
    for command in program["commands"]:
        text += f"\n{first} -a {command['name']} -d {fish_quoted(command['title'])}\n"
        text += "".join(fish_form(start, command, form) for form in command["forms"])
    return text
